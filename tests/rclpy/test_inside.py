"""Runs each file and each folder of `inside/` with pytest in a process whose rclpy is ours.

Our rclpy and the real one can never share a process, and this one may have the real one.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.inside_underlay import has_slow_tests, run

HERE = Path(__file__).parent

PARTS = sorted(
    part for part in (HERE / "inside").iterdir() if part.match("test_*.py") or any(part.glob("test_*.py"))
)
# Both codecs, where bytes of other definitions are read.
ALSO_IN_PYTHON = {"mismatched_topics", "test_mismatch_services"}
# Several seconds each; `contract` has something of each of these.
LONG = {
    "test_adapting_services_across",
    "test_lockstep",
    "test_mismatch_across",
    "test_network_faults",
    "test_pairs",
    "test_shared_memory",
}
RUNS = [
    pytest.param(part, "", id=part.stem, marks=[pytest.mark.slow] if part.stem in LONG else [])
    for part in PARTS
]
RUNS += [
    pytest.param(part, "python", id=f"{part.stem}python", marks=pytest.mark.slow)
    for part in PARTS
    if part.stem in ALSO_IN_PYTHON
]


@pytest.mark.parametrize(("part", "codec"), RUNS)
def test_part(part: Path, codec: str, tmp_path: Path) -> None:
    """Every test in it passes, but for the slow ones."""
    run(part, tmp_path, IFGEN_CODEC=codec)


@pytest.mark.slow
@pytest.mark.parametrize("part", [part for part in PARTS if has_slow_tests(part)], ids=lambda part: part.stem)
def test_more_of_part(part: Path, tmp_path: Path) -> None:
    """Every slow test in it passes."""
    run(part, tmp_path, slow=True)


@pytest.mark.slow
def test_more_hostile_bytes(tmp_path: Path) -> None:
    run(HERE / "inside/test_hostile_bytes.py", tmp_path, IFGEN_CASES="400")
