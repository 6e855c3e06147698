"""Runs the tests of each tool that need our rclpy in a process whose rclpy is ours."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.inside_underlay import has_slow_tests, run

PARTS = sorted(Path(__file__).parent.glob("*/inside"))


@pytest.mark.parametrize("part", PARTS, ids=[part.parent.name for part in PARTS])
def test_part(part: Path, tmp_path: Path) -> None:
    """Every test in it passes, but for the slow ones."""
    run(part, tmp_path)


SLOW = [part for part in PARTS if has_slow_tests(part)]


@pytest.mark.slow
@pytest.mark.parametrize("part", SLOW, ids=[part.parent.name for part in SLOW])
def test_more_of_part(part: Path, tmp_path: Path) -> None:
    """Every slow test in it passes."""
    run(part, tmp_path, slow=True)
