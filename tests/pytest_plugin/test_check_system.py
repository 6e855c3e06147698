"""The fixture `check_system`: a launch file beside a test."""

from __future__ import annotations

import pytest

pytest_plugins = ("pytester",)

LAUNCH = """<launch>
  <node pkg="battery_monitor" exec="battery_monitor" name="battery_monitor">
    <remap from="/batery" to="/power"/>
  </node>
</launch>
"""
TEST = """
import pytest


def test_it(check_system):
    with pytest.raises(AssertionError, match="did you mean `/battery`?"):
        check_system("robot.launch.xml")


def test_it_once_it_is_right(check_system, tmp_path):
    text = open("robot.launch.xml").read().replace("/batery", "/battery")
    (tmp_path / "right.launch.xml").write_text(text)
    system = check_system(tmp_path / "right.launch.xml", ignore=["system-no-server"])
    assert [node.name for node in system.nodes] == ["/battery_monitor"]
    assert "/power" in {end.name for end in system.endpoints}
"""


@pytest.mark.slow
def test_a_launch_file_beside_a_test(pytester: pytest.Pytester) -> None:
    pytester.makefile(".launch.xml", robot=LAUNCH)
    pytester.makepyfile(TEST)
    pytester.runpytest_subprocess("--transport", "local", timeout=60).assert_outcomes(passed=2)
