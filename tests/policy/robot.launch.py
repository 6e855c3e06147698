"""A system with each kind of endpoint."""

from launch import LaunchDescription
from launch_ros.actions import Node, PushRosNamespace


def generate_launch_description():
    return LaunchDescription(
        [
            PushRosNamespace("robot"),
            *(Node(package="robot", executable=name, name=name) for name in ("driver", "mapper", "planner")),
            Node(package="robot", executable="mover", name="mover", remappings=[("cmd", "cmd_vel")]),
            Node(package="robot", executable="camera", name="camera", parameters=[{"use_sim_time": True}]),
        ]
    )
