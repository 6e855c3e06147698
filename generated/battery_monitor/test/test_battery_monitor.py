"""Tests of what the node battery_monitor does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from battery_monitor._battery_monitor_base import BATTERY_PUBLISHER_QOS, BATTERY_STATE_SUBSCRIPTION_QOS
from battery_monitor.battery_monitor import BatteryMonitor
from humanoid_interfaces.msg import BatteryStatus
from sensor_msgs.msg import BatteryState
from std_srvs.srv import SetBool


@pytest.mark.parametrize(
    ("charge", "level", "stops"),
    [
        (None, BatteryStatus.LEVEL_UNKNOWN, False),
        (0.7, BatteryStatus.LEVEL_NORMAL, False),
        (0.2, BatteryStatus.LEVEL_LOW, False),
        (0.05, BatteryStatus.LEVEL_CRITICAL, True),
    ],
)
def test_the_level_follows_the_charge_and_a_critical_one_stops_the_robot(
    ros: Any, charge: float | None, level: int, stops: bool
) -> None:
    pressed: list[bool] = []

    def press(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        pressed.append(request.data)
        return response

    ros.serve(SetBool, "/emergency_stop/set", press)
    node = ros.start(BatteryMonitor)
    measured = ros.peer.create_publisher(BatteryState, "/battery_state", BATTERY_STATE_SUBSCRIPTION_QOS)
    heard: list[BatteryStatus] = []
    ros.peer.create_subscription(BatteryStatus, "/battery", heard.append, BATTERY_PUBLISHER_QOS)
    ros.spin_until(node.emergency_stop_set_client.service_is_ready, "the emergency stop")

    def second() -> None:
        ros.pass_time(1.0)
        if charge is not None:
            reading = BatteryState(percentage=charge, voltage=48.1, current=-3.2)
            reading.header.stamp = node.get_clock().now().to_msg()
            measured.publish(reading)

    ros.deliver(second, lambda: heard and heard[-1].level == level, f"level {level} on /battery")
    if stops:
        ros.spin_until(lambda: pressed, "request for an emergency stop")
        for _ in range(3):
            ros.pass_time(1.0)
    assert pressed == ([True] if stops else [])
