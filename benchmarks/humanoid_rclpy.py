"""The humanoid on real rclpy: a walk to a goal and a cancelled one, in lockstep and in real time.

python benchmarks/humanoid_rclpy.py [--quick]     one walk of each instead of three, and ten in real time

`ifgen demo --scenario walk`, for which physics, motion, limbs and tasks have a process each there. Real time
is real only on a machine that has nothing else to do.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys

from _demo import Run, play, span
from _table import Row, is_quick, show

LOCKSTEP = {"local transport, in lockstep": (), "real rclpy, in lockstep": ("--transport", "rclpy")}
WALK = ("--scenario", "walk")
REAL_TIME = (*WALK, "--transport", "rclpy", "--realtime")
BUSY = "while True: pass"


def main() -> None:
    """Measure and print."""
    if importlib.util.find_spec("rpyutils") is None:
        print("real rclpy is not installed")
        return
    show([lockstep, real_time, busy], is_quick(__doc__))


def lockstep(quick: bool) -> list[Row]:
    """The transports in turn, several times."""
    played = [
        (mode, play(*WALK, *words)) for _ in range(1 if quick else 3) for mode, words in LOCKSTEP.items()
    ]
    rows: list[Row] = []
    for mode in LOCKSTEP:
        runs = [run for one, run in played if one == mode]
        rows.append((f"{len(runs)} walks, {mode}", "no fall", "; ".join(map(words_of, runs))))
    return rows


def real_time(quick: bool) -> list[Row]:
    """Walks in real time."""
    runs = [play(*REAL_TIME) for _ in range(1 if quick else 10)]
    what = f"{len(runs)} walks, real rclpy, in real time"
    return [(what, "9 of 10 reach the goal", count(runs))]


def busy(quick: bool) -> list[Row]:
    """The same while another program takes the time of a processor."""
    with subprocess.Popen([sys.executable, "-c", BUSY]) as other:
        try:
            runs = [play(*REAL_TIME) for _ in range(1 if quick else 10)]
        finally:
            other.kill()
    return [(f"{len(runs)} of them with one core kept busy", "go on after HOLDING", count(runs))]


def count(runs: list[Run]) -> str:
    """How many reached the goal, the ranges of their errors, and what kept the others from it."""
    reached = [run for run in runs if run.rows["outcome"] == "done"]
    words = [f"{len(reached)}, {sum(int(run.number('falls') or 0) for run in runs)} falls"]
    words += [f"{row} {values} mm" for row in ("foot error", "goal error") if (values := span(reached, row))]
    words += [run.rows["outcome"] for run in runs if run not in reached]
    return "; ".join(words)


def words_of(run: Run) -> str:
    """A run in a few words."""
    summary = run.rows
    if summary["outcome"] != "done":
        return summary["outcome"]
    return (
        f"{summary['real-time factor']}x, {summary['falls']} falls, foot error {summary['foot error']}, "
        f"goal error {summary['goal error'].removesuffix(' at most')}"
    )


if __name__ == "__main__":
    main()
