"""Walks between obstacles that the robot has to find with its camera.

benchmarks/humanoid_obstacles.py walks through twenty scenes.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from humanoid.simulation import rendering

LIBRARY = str(Path(__file__).parents[2] / "examples/humanoid")
# In a process of its own, whose rclpy is ours.
PROGRAM = """
import dataclasses, json, sys
import ifgen
sys.path.insert(0, sys.argv[1])
ifgen.activate("local")
from humanoid.trials.obstacle_trials import walks
found = [walks(seeds, moving=moving) for seeds, moving in zip(json.loads(sys.argv[2]), (False, True))]
print(json.dumps([[dataclasses.asdict(scene) for scene in scenes] for scenes in found]))
"""


def walked(standing: list[int], moving: list[int]) -> list[list[dict[str, Any]]]:
    """The walks in the scenes of these seeds: where all stays as it is, and where an obstacle is moved."""
    try:
        rendering.choose_gl()
    except rendering.RenderingError as error:
        pytest.skip(str(error))
    command = [sys.executable, "-c", PROGRAM, LIBRARY, json.dumps([standing, moving])]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3000, check=False)
    assert done.returncode == 0, done.stderr
    scenes: list[list[dict[str, Any]]] = json.loads(done.stdout.splitlines()[-1])
    return scenes


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_it_walks_round_obstacles_that_it_sees() -> None:
    standing, moving = walked([9], [0, 6, 13])
    for scene in standing + moving:
        assert (scene["reached"], scene["falls"], scene["touches"]) == (True, 0, 0), scene
        assert scene["obstacles"] == 5
        assert scene["error"] < 0.06
        assert scene["length"] > 4.0
    assert all(scene["moved"] for scene in moving)  # on its way, in front of it
