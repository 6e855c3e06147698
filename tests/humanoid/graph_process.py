"""Plays trials over the node graph, each in a graph of its own, in a process whose rclpy is ours.

python graph_process.py '[["stand", [5.0], {"seed": 1}], ...]'     prints the results as JSON
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any


def play(*trials: tuple[str, list[Any], dict[str, Any]], hash_seed: int = 0) -> list[dict[str, Any]]:
    """Play trials in another process: functions of `humanoid.trials.graph_trials`, their arguments, the graph's options.

    Returns for each the result or the problem, the score and the state hash. The option `split` puts the
    simulator into a process of its own.
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

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples"))
    ifgen.activate("local")
    print(json.dumps([_play(*each) for each in json.loads(sys.argv[1])]))


def _play(trial: str, arguments: list[Any], options: dict[str, Any]) -> dict[str, Any]:
    from humanoid.show.director import ScenarioError
    from humanoid.trials import bridge, graph_trials
    from humanoid.trials.graph import NodeGraph

    make = bridge.split if options.pop("split", False) else NodeGraph
    found: dict[str, Any] = {"problem": ""}
    with make(**options) as graph:
        try:
            played = graph.play(lambda director: getattr(graph_trials, trial)(director, *arguments))
        except ScenarioError as error:
            found["problem"] = str(error)
        else:
            found.update(result=played.result, hash=played.state_hash)
        score = graph.director.score
    return {**found, **asdict(score), "foot_error": score.foot_error}


if __name__ == "__main__":
    _main()
