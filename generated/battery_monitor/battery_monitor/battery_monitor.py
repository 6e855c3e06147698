"""The node battery_monitor: written once by ifgen, yours from then on.

`ifgen run -m battery_monitor.battery_monitor` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.msg import BatteryStatus
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import BatteryState

from battery_monitor._battery_monitor_base import BatteryMonitorBase
from battery_monitor._battery_monitor_parameters import ParametersError


class BatteryMonitor(BatteryMonitorBase):
    """Watches the battery, estimates how long it will last, and calls for an emergency stop before it is
    empty. A robot without power falls.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def on_battery_state(self, message: BatteryState) -> None:
        """Take a message from `/battery_state`.

        Voltage [V] and current [A] as measured
        """
        self.get_logger().debug("message on /battery_state")

    def on_report_timer(self) -> None:
        """Called every 1 s."""
        self.publish_battery(BatteryStatus())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = BatteryMonitor()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"battery_monitor: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
