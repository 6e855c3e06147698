"""The same seed gives the same run over the node graph: a walk, a push, a cancel, and a hash over every moment."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from .graph_process import play

pytestmark = pytest.mark.timeout(300)


def _hashes(*options: dict[str, Any], hash_seed: int = 0) -> list[str]:
    """The state hashes of one run for each of these options of the graph, in one other process."""
    runs = play(*(("disturbed", [], each) for each in options), hash_seed=hash_seed)
    for run in runs:
        assert run["problem"] == ""
        assert run["steps"] >= 2
        assert (run["pushes"], run["falls"], len(run["stop_times"])) == (1, 0, 1)
    return [run["hash"] for run in runs]


@pytest.mark.slow
def test_a_graph_built_again_runs_the_same() -> None:
    """In one process, a graph is built, played with, destroyed, and built again."""
    first, again, other = _hashes({"seed": 1}, {"seed": 1}, {"seed": 2})
    assert first == again != other


def test_another_process_runs_the_same_however_long_it_is_held_up() -> None:
    assert _hashes({"seed": 1, "stalls": True}, hash_seed=77) == _hashes({"seed": 1})


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_busy_machine_changes_nothing() -> None:
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(4)]
    try:
        first, again = _hashes({"seed": 1}, {"seed": 1})
    finally:
        for process in busy:
            process.kill()
            process.wait()
    assert first == again == _hashes({"seed": 1})[0]


@pytest.mark.slow
def test_nodes_in_four_processes_run_as_in_one() -> None:
    one, four, again, other = _hashes(
        {"seed": 1, "processes": 1},
        {"seed": 1, "processes": 4},
        {"seed": 1, "processes": 4},
        {"seed": 2, "processes": 4},
    )
    assert one == four == again != other
