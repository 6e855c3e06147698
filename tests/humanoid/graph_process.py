"""Plays trials over the node graph, each in a graph of its own, in a process whose rclpy is ours.

python graph_process.py '[["stand", [5.0], {"seed": 1}], ...]'     prints the results as JSON
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Any


def play(*trials: tuple[str, list[Any], dict[str, Any]], hash_seed: int = 0) -> list[dict[str, Any]]:
    """Play trials in another process: functions of `humanoid.trials.graph_trials`, their arguments, the graph's options.

    Returns for each the result or the problem, the score and the state hash. With the option `processes`, the nodes
    are in lockstep, in one process or in four. With the option `stalls`, the process seems to be held up for long
    again and again.
    """
    done = subprocess.run(
        [sys.executable, __file__, json.dumps(trials)],
        capture_output=True,
        text=True,
        timeout=1500,
        env={**os.environ, "PYTHONHASHSEED": str(hash_seed)},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: list[dict[str, Any]] = json.loads(done.stdout.splitlines()[-1])
    return found


def _main() -> None:
    import ifgen

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples/humanoid"))
    ifgen.activate("local")
    print(json.dumps([_play(*each) for each in json.loads(sys.argv[1])]))


def _play(trial: str, arguments: list[Any], options: dict[str, Any]) -> dict[str, Any]:
    from humanoid.trials import graph_trials, spread
    from humanoid.trials.graph import NodeGraph
    from humanoid.trials.user import ScenarioError

    if options.pop("stalls", False):
        module = import_module("humanoid_simulator.humanoid_simulator")
        module.time = _Stalled()  # type: ignore[attr-defined]
    if "processes" in options:
        played, problem, score = spread.play(trial, arguments, **options)
    else:
        played, problem = None, ""
        with NodeGraph(**options) as graph:
            try:
                played = graph.play(lambda director: getattr(graph_trials, trial)(director, *arguments))
            except ScenarioError as error:
                problem = str(error)
            score = graph.user.score
    found = {"result": played.result, "hash": played.state_hash} if played else {}
    return {**found, "problem": problem, **asdict(score), "foot_error": score.foot_error}


class _Stalled:
    """The clock of a process that gets no processor time for 100 s between any two looks at it."""

    sleep = staticmethod(time.sleep)

    def __init__(self) -> None:
        self._now = 0.0

    def monotonic(self) -> float:
        self._now += 100.0
        return self._now


if __name__ == "__main__":
    _main()
