"""Tests of what the node emergency_stop does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from emergency_stop.emergency_stop import EmergencyStop
from std_srvs.srv import SetBool


def test_handle_set(ros: Any) -> None:
    """The service answers with defaults so far; say here what it should answer."""
    node = ros.start(EmergencyStop, use_sim_time=False)
    name = node.resolve_service_name("~/set")
    response = ros.call(SetBool, name, SetBool.Request())
    assert response == SetBool.Response()
