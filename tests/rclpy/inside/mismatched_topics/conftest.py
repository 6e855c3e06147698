"""Each test has ROS running, and no adapters but its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import in_one_line

from tests.rclpy.inside.mismatched_topics.speeds import nodes


@pytest.fixture(autouse=True)
def _ros(no_adapters: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(reporting, "explanation", in_one_line)  # whether or not the toolkit is installed
    rclpy.init()
    yield
    while nodes:
        nodes.pop().destroy_node()
    rclpy.try_shutdown()
