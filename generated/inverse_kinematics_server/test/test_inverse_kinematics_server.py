"""Tests of what the node inverse_kinematics_server does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from humanoid_interfaces.srv import SolveIK
from inverse_kinematics_server.inverse_kinematics_server import InverseKinematicsServer


def test_handle_solve_ik(ros: Any) -> None:
    """The service answers with defaults so far; say here what it should answer."""
    node = ros.start(InverseKinematicsServer, use_sim_time=False)
    name = node.resolve_service_name("/solve_ik")
    response = ros.call(SolveIK, name, SolveIK.Request())
    assert response == SolveIK.Response()
