"""The fixture `nodl_conforms` on both transports: a node of a test against its document."""

from __future__ import annotations

import pytest

from .support import needs_rclpy

pytest_plugins = ("pytester",)

DOCUMENT = """nodl_version: 2
parameters: {gain: {type: double, default_value: 1.5}}
publishers:
  - {name: ~/out, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 10, reliability: RELIABLE}}
"""
TEST = """
import pytest
from ifgen_tools.nodl.testing import nodl_conforms
from std_msgs.msg import String


def test_it(ros_node, nodl_conforms):
    node = ros_node("talker")
    node.create_publisher(String, "~/out", 10)
    node.declare_parameter("gain", 1.5)
    nodl_conforms(node, "talker.nodl.yaml")
    node.declare_parameter("more", 1)
    with pytest.raises(AssertionError, match="extra. parameters 'more'"):
        nodl_conforms(node, "talker.nodl.yaml", timeout=0.0)
    report = nodl_conforms(node, "talker.nodl.yaml", ignore=["parameter:more"])
    assert [each.name for each in report.ignored] == ["more"]
"""


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=needs_rclpy)])
def test_a_node_against_its_document(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makefile(".nodl.yaml", talker=DOCUMENT)
    pytester.makepyfile(TEST)
    pytester.runpytest_subprocess("--transport", transport, timeout=60).assert_outcomes(passed=1)
