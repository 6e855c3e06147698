from pathlib import Path

from launch import LaunchDescription
from launch.actions import Shutdown
from launch_ros.actions import Node

HERE = Path(__file__).parent


def generate_launch_description() -> LaunchDescription:
    description = (HERE / "arm.urdf").read_text()
    return LaunchDescription(
        [
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
            Node(package="joint_state_publisher", executable="joint_state_publisher"),
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                arguments=["--x", "-1.5", "--yaw", "-1e-7", "--frame-id", "map", "--child-frame-id", "base"],
            ),
            Node(executable="check.py", output="screen", on_exit=Shutdown()),
        ]
    )
