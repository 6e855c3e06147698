"""The humanoid between obstacles that it must find with its camera: targets and measurements.

python benchmarks/humanoid_obstacles.py [--quick]     fewer scenes

Five solid obstacles at random places, which differ by the seed, and a goal 4 m ahead, over the whole node
graph in lockstep on the local transport. Times are simulated; lengths and errors are true ones.
"""

from __future__ import annotations

import statistics
import sys
from pathlib import Path

from _table import Row, is_quick, show

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "examples/humanoid"))
import ifgen

ifgen.activate("local")

# ruff: noqa: E402  # importable only from here on
from humanoid.trials.obstacle_trials import Scene, walks


def main() -> None:
    """Measure and print."""
    show((scenes, moved), is_quick(__doc__))


def scenes(quick: bool) -> list[Row]:
    """Walks through random scenes."""
    return _rows(walks(range(3 if quick else 20)), "")


def moved(quick: bool) -> list[Row]:
    """The same, where an obstacle is put in front of the robot on its way."""
    found = walks(range(2 if quick else 10), moving=True)
    return _rows([scene for scene in found if scene.moved], ", an obstacle moved in front of it")


def _rows(found: list[Scene], what: str) -> list[Row]:
    there = [scene for scene in found if scene.reached]
    reasons = "; ".join(f"{scene.seed}: {scene.reason}" for scene in found if not scene.reached)
    seeds = f"{len(found)} scenes (seeds {found[0].seed} to {found[-1].seed}){what}" if found else "no scene"
    return [
        (f"goals reached, {seeds}", ">= 95 %", f"{len(there)}{f' ({reasons})' if reasons else ''}"),
        ("falls", "0", str(sum(scene.falls for scene in found))),
        ("touches of obstacles", "0", str(sum(scene.touches for scene in found))),
        ("way, straight line 4 m", "", _spread([scene.length for scene in there], "m")),
        ("time", "", _spread([scene.seconds for scene in there], "s")),
        ("distance from the goal at the end", "", _spread([scene.error * 1e3 for scene in there], "mm")),
    ]


def _spread(values: list[float], unit: str) -> str:
    if not values:
        return "none"
    return f"{statistics.median(values):.1f} {unit} median, {max(values):.1f} {unit} at most"


if __name__ == "__main__":
    main()
