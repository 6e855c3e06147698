"""Record a transcript again: `python -m tests.tools.record ROS2 SCENE [PATTERN]` with the path of a ros2 of Jazzy.

With a PATTERN, only the command lines that it is found in; those that change the scene need all before them.
A new command line is written into a transcript as `$ topic list`, and recorded like the others.
"""

from __future__ import annotations

import re
import sys
from dataclasses import replace

from ifgen_pytest.domains import own_domain

from tests.tools.transcript import PLACE, Run, environment, playing, read, write


def main(ros2: str, scene: str, pattern: str = "") -> None:
    """Play a scene on real rclpy, and run the command lines of its transcript."""
    path = PLACE / f"{scene}.txt"
    with own_domain() as domain:
        # Without its daemon, ros2 looks for 0.5 s: too short on a busy machine.
        around = {**environment(domain), "ROS2_SPIN_TIME": "4"}
        with playing(scene, "rclpy", around):
            runs = [
                _recorded(run, ros2, around) if re.search(pattern, run.words) else run for run in read(path)
            ]
    write(path, runs)


def _recorded(run: Run, ros2: str, around: dict[str, str]) -> Run:
    """What comes of a command line, asked up to three times: on a busy machine ros2 misses some of the nodes."""
    for _ in range(3):
        found = run.again([ros2], around)
        if found.code == 0 or not found.err:
            break
    return replace(found, err=found.err.replace(sys.prefix, "PREFIX"))


if __name__ == "__main__":
    main(*sys.argv[1:])
