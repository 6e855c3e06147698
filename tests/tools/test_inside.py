"""Runs the tests of each tool that need our rclpy in a process whose rclpy is ours."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.inside_underlay import run

PARTS = sorted(Path(__file__).parent.glob("*/inside"))


@pytest.mark.parametrize("part", PARTS, ids=[part.parent.name for part in PARTS])
def test_part(part: Path, tmp_path: Path) -> None:
    """Every test in it passes."""
    run(part, tmp_path)
