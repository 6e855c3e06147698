"""The node high_level_task_manager: written once by ifgen, yours from then on.

`ifgen run -m high_level_task_manager.high_level_task_manager` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.msg import BatteryStatus, DetectedObjectArray, EmergencyStop
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String

from high_level_task_manager._high_level_task_manager_base import HighLevelTaskManagerBase
from high_level_task_manager._high_level_task_manager_parameters import ParametersError

# fmt: off


class HighLevelTaskManager(HighLevelTaskManagerBase):
    """Turns spoken commands and what the robot sees into goals, one at a time, and gives up on them when
    the battery runs low or somebody presses the emergency stop.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    async def on_speech_text(self, message: String) -> None:
        """Take a message from `/speech/text`.

        Spoken commands, such as `walk home`, `dance`, `stop`
        """
        self.get_logger().debug("message on /speech/text")

    async def on_face_detection_detections(self, message: DetectedObjectArray) -> None:
        """Take a message from `/face_detection/detections`.

        Faces that the camera sees
        """
        self.get_logger().debug("message on /face_detection/detections")

    async def on_battery(self, message: BatteryStatus) -> None:
        """Take a message from `/battery`.

        How long the battery will last
        """
        self.get_logger().debug("message on /battery")

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Take a message from `/emergency_stop`.

        Cancels the current task
        """
        self.get_logger().debug("message on /emergency_stop")

    async def on_state_timer(self) -> None:
        """Called every 1 s."""
        self.publish_state(String())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = HighLevelTaskManager()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"high_level_task_manager: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
