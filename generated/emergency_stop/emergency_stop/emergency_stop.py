"""The node emergency_stop: written once by ifgen, yours from then on.

`ifgen run -m emergency_stop.emergency_stop` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.msg import BatteryStatus, GaitState
from humanoid_interfaces.msg import EmergencyStop as humanoid_interfaces_msg_EmergencyStop
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import SetBool

from emergency_stop._emergency_stop_base import EmergencyStopBase
from emergency_stop._emergency_stop_parameters import ParametersError

# fmt: off


class EmergencyStop(EmergencyStopBase):
    """Holds the emergency stop. Any node can set it, but only a person should release it. The node sets it
    without being asked when the robot has fallen or the battery is critical.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_emergency_stop(humanoid_interfaces_msg_EmergencyStop())

    def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        Whether the robot has fallen, or was stopped before this node started
        """
        self.get_logger().debug("message on /gait_state")

    def on_battery(self, message: BatteryStatus) -> None:
        """Take a message from `/battery`.

        Whether the battery is critical
        """
        self.get_logger().debug("message on /battery")

    def handle_set(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answer a request to `~/set`.

        Press the button, or release it
        """
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = EmergencyStop()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"emergency_stop: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
