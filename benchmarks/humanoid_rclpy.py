"""The humanoid on real rclpy: a walk to a goal and a cancelled one, in lockstep and in real time.

python benchmarks/humanoid_rclpy.py [--quick]     one walk of each instead of three

`ifgen demo --scenario walk`, for which physics, motion, limbs and tasks have a process each there. Real time
is real only on a machine that has nothing else to do.
"""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys

from _table import Row, is_quick, show

DOMAIN = "93"
MODES = {
    "local transport, in lockstep": [],
    "real rclpy, in lockstep": ["--transport", "rclpy"],
    "real rclpy, in real time": ["--transport", "rclpy", "--realtime"],
}


def main() -> None:
    """Measure and print."""
    if importlib.util.find_spec("rpyutils") is None:
        print("real rclpy is not installed")
        return
    show([walks], is_quick(__doc__))


def walks(quick: bool) -> list[Row]:
    """The modes in turn, several times."""
    runs = [(mode, play(words)) for _ in range(1 if quick else 3) for mode, words in MODES.items()]
    rows: list[Row] = []
    for mode in MODES:
        summaries = [summary for played, summary in runs if played == mode]
        asked = "no fall, real time" if "in real time" in mode else "no fall"
        rows.append((f"{len(summaries)} walks, {mode}", asked, "; ".join(map(words_of, summaries))))
    return rows


def play(words: list[str]) -> dict[str, str]:
    """The summary of the demo, by row."""
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": DOMAIN,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    command = [sys.executable, "-m", "ifgen", "demo", "--headless", "--scenario", "walk", *words]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600, check=False)
    rows = re.findall(r"^  (\S.*?)  +(\S.*)$", done.stdout.partition("\n\n")[2], re.MULTILINE)
    return dict(rows) or {"outcome": done.stderr.strip()}


def words_of(summary: dict[str, str]) -> str:
    """A run in a few words."""
    if summary["outcome"] != "done":
        return summary["outcome"]
    return (
        f"{summary['real-time factor']}x, {summary['falls']} falls, foot error {summary['foot error']}, "
        f"goal error {summary['goal error'].removesuffix(' at most')}"
    )


if __name__ == "__main__":
    main()
