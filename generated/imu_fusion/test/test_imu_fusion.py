"""Tests of what the node imu_fusion does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from imu_fusion.imu_fusion import ImuFusion
from std_srvs.srv import Trigger


def test_handle_reset(ros: Any) -> None:
    """The service answers with defaults so far; say here what it should answer."""
    node = ros.start(ImuFusion)
    name = node.resolve_service_name("~/reset")
    client = ros.peer.create_client(Trigger, name)
    ros.spin_until(client.service_is_ready, "service")
    response = ros.result(client.call_async(Trigger.Request()), "response")
    assert response == Trigger.Response()
