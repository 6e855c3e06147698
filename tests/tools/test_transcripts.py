"""Our commands print what those of ros2 print, on the same scenes. Transcripts of ros2 are kept as facts.

`python -m tests.tools.record ROS2` records them again with a ros2 of Jazzy.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.tools.differences import IN_ANY_RUN, ON_PURPOSE, compared
from tests.tools.transcript import PLACE, Run, environment, playing, read, write

SCENES = sorted(path.stem for path in PLACE.glob("*.txt"))
TRANSPORTS = ("local", "rclpy")


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("scene", SCENES)
def test_as_ros2(scene: str, transport: str, tmp_path: Path) -> None:
    """Every difference of a scene at once, as a diff of transcripts."""
    expected = read(PLACE / f"{scene}.txt")
    with own_domain() as domain:
        around = environment(domain)
        with playing(scene, transport, around):
            found = [_again(run, transport, around) for run in expected]
    write(tmp_path / "found.txt", found)
    wrong = [
        f"{theirs}\n--- is now ---\n{ours}"
        for theirs, ours in zip(map(compared, expected), map(compared, found), strict=True)
        if theirs != ours
    ]
    assert not wrong, f"{len(wrong)} of {len(found)} differ\n\n" + "\n\n".join(wrong)


def _again(run: Run, transport: str, around: dict[str, str]) -> Run:
    """What ours prints; on the real rclpy at a later try, too: there, nobody knows when all are discovered."""
    options = [] if run.words.startswith("interface") else ["--transport", transport]
    for _ in range(1 if transport == "local" else 3):
        found = run.again([sys.executable, "-m", "ifgen"], around, options)
        if compared(found) == compared(run):
            break
    return found


def test_transcripts_read_and_write(tmp_path: Path) -> None:
    for scene in SCENES:
        text = (PLACE / f"{scene}.txt").read_text()
        write(tmp_path / "again.txt", read(PLACE / f"{scene}.txt"))
        assert (tmp_path / "again.txt").read_text() == text


def test_every_difference_is_about_something() -> None:
    runs = [run for scene in SCENES for run in read(PLACE / f"{scene}.txt")]
    for difference in (*IN_ANY_RUN, *ON_PURPOSE):
        assert any(re.match(difference.commands, run.words) for run in runs), difference.why
