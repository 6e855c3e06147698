"""Runs each file and each folder of `inside/` with pytest in a process whose rclpy is ours.

Our rclpy and the real one can never share a process, and this one may have the real one.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.inside_underlay import run

HERE = Path(__file__).parent

PARTS = sorted(
    part for part in (HERE / "inside").iterdir() if part.match("test_*.py") or any(part.glob("test_*.py"))
)
# Both codecs, where bytes of other definitions are read.
ALSO_IN_PYTHON = {"mismatched_topics", "test_mismatch_services"}
RUNS = [pytest.param(part, "", id=part.stem) for part in PARTS]
RUNS += [
    pytest.param(part, "python", id=f"{part.stem}python", marks=pytest.mark.slow)
    for part in PARTS
    if part.stem in ALSO_IN_PYTHON
]


@pytest.mark.parametrize(("part", "codec"), RUNS)
def test_part(part: Path, codec: str, tmp_path: Path) -> None:
    """Every test in it passes."""
    run(part, tmp_path, IFGEN_CODEC=codec)


@pytest.mark.slow
def test_more_hostile_bytes(tmp_path: Path) -> None:
    run(HERE / "inside/test_hostile_bytes.py", tmp_path, IFGEN_CASES="400")
