"""Timers by the clock of ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from launch.actions import TimerAction
from launch.launch_context import LaunchContext, Timer


class RosTimer(TimerAction):
    """Actions that are done after a time [s] by ROS: by /clock after SetUseSimTime, else by the machine."""

    def start(
        self, context: LaunchContext, seconds: float, call: Callable[[], None], *, until_shutdown: bool
    ) -> Timer:
        """Start to wait by a timer of the launch's node."""
        # They import an rclpy, which few launches need.
        from rclpy.parameter import Parameter

        from launch_ros.ros_adapters import get_ros_node

        node = get_ros_node(context)
        uses = dict(each for each in context.launch_configurations.get("global_params", ()) if len(each) == 2)
        if uses.get("use_sim_time"):
            node.set_parameters([Parameter("use_sim_time", value=True)])
        waits = context.host.later(None, call, until_shutdown=until_shutdown)

        def come() -> None:
            timer.cancel()
            context.host.post(waits.fire)

        timer: Any = node.create_timer(seconds, come)
        return waits
