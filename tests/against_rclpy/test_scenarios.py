"""Every scenario prints the same on the real rclpy and on ours."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

_HARNESS = Path(__file__).with_name("harness.py")
_SPEC = importlib.util.spec_from_file_location("against_rclpy_harness", _HARNESS)
assert _SPEC is not None and _SPEC.loader is not None
harness = importlib.util.module_from_spec(_SPEC)
sys.modules[_SPEC.name] = harness  # dataclasses look their module up
_SPEC.loader.exec_module(harness)

# Two seconds or more, several of them waits on the real rclpy; the others have something of each subject.
LONG = {
    "action_peers",
    "action_threads",
    "comm_bytes",
    "comm_events",
    "comm_types_and_waiting",
    "exec_rounds",
    "exec_signals",
    "node_arguments",
    "time_clocks",
}
SCENARIOS = sorted(harness.SCENARIOS.glob("*.py"))
CASES = [
    pytest.param(path, id=path.stem, marks=[pytest.mark.slow] if path.stem in LONG else [])
    for path in SCENARIOS
]


@pytest.mark.skipif(harness.real_rclpy_missing() is not None, reason=str(harness.real_rclpy_missing()))
@pytest.mark.timeout(4 * harness.TIME_LIMIT)
@pytest.mark.parametrize("scenario", CASES)
def test_prints_the_same(scenario: Path) -> None:
    """The transcripts are equal and both runs end with code 0."""
    report = harness.compare(scenario)
    if report is not None:
        # Real discovery is sometimes late on a busy machine; a transcript that differs twice does differ.
        report = harness.compare(scenario)
    assert report is None, report
