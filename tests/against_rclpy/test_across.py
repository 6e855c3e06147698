"""What works in one process works in two, and two on the local transport say what two on real rclpy say."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.against_rclpy import two_processes
from tests.against_rclpy.harness import real_rclpy_missing

pytest.importorskip("zenoh")
if not two_processes.IS_POSSIBLE:
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)

SCENARIOS = sorted(two_processes.ACROSS.glob("*.py"))
QUICK = {"services"}  # which has messages, events, and answers in both directions

every_scenario = pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda path: path.stem)


@pytest.mark.parametrize(
    "scenario",
    [pytest.param(path, marks=() if path.stem in QUICK else pytest.mark.slow) for path in SCENARIOS],
    ids=lambda path: path.stem,
)
@pytest.mark.timeout(4 * two_processes.TIME_LIMIT)
def test_two_processes_say_what_one_says(scenario: Path) -> None:
    report = two_processes.against_one(scenario)
    assert report is None, report


@pytest.mark.slow
@pytest.mark.skipif(real_rclpy_missing() is not None, reason=str(real_rclpy_missing()))
@pytest.mark.timeout(4 * two_processes.TIME_LIMIT)
@every_scenario
def test_two_processes_say_what_two_on_real_rclpy_say(scenario: Path) -> None:
    report = two_processes.against_real(scenario)
    if report is not None:
        # Real discovery is sometimes late on a busy machine; a transcript that differs twice does differ.
        report = two_processes.against_real(scenario)
    assert report is None, report
