"""A user's node with topics: what strict type checkers accept, and what they refuse."""

from __future__ import annotations

from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Point, Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.timer import Timer


class Pilot(Node):
    """Drives towards points."""

    def __init__(self) -> None:
        super().__init__("pilot")
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.status: Publisher[DiagnosticStatus] = self.create_publisher(
            DiagnosticStatus, "status", QoSProfile(depth=1)
        )
        self.goals: Subscription[Point] = self.create_subscription(Point, "goal", self.drive, 10)
        self.create_subscription(Point, "goal", self.drive_slowly, 10)
        self.create_subscription(Point, "goal", self.drive_when_new, 10)
        self.create_subscription(Point, "goal", self.record, 10, raw=True)
        self.create_subscription(Point, "goal", self.record_with_info, 10, raw=True)
        self.create_subscription(Point, "goal", lambda point: print(point.x), 10)
        self.create_subscription(
            Point, "goal", lambda point, info: print(point.x, info["source_timestamp"]), 10
        )
        self.beat: Timer = self.create_timer(0.1, self.publish_status)
        self.create_timer(0.5, self.publish_status_slowly)

        self.wrong: Publisher[Twist] = self.create_publisher(
            Point, "x", 1
        )  # refused: arg-type, reportAttributeAccessIssue
        self.create_publisher(Twist, "x", "10")  # refused: arg-type, reportArgumentType
        self.create_publisher(Twist(), "x", 10)  # refused: arg-type, reportArgumentType
        self.create_subscription(Twist, "x", self.drive, 10)  # refused: arg-type, reportArgumentType
        self.create_subscription(Point, "x", self.record, 10)  # refused: arg-type, reportArgumentType
        self.create_subscription(
            Point, "x", self.drive, 10, raw=True
        )  # refused: call-overload, reportArgumentType
        self.create_subscription(
            Point, "x", lambda point: print(point.speed), 10
        )  # refused: attr-defined, reportAttributeAccessIssue
        self.create_subscription(Point, "x", self.publish_status, 10)  # refused: arg-type, reportArgumentType
        self.create_timer(0.1, self.drive)  # refused: arg-type, reportArgumentType
        self.create_timer("0.1", self.publish_status)  # refused: arg-type, reportArgumentType

    def drive(self, point: Point) -> None:
        self.commands.publish(Twist())
        self.commands.publish(b"\0\1\0\0")
        self.commands.publish(point)  # refused: arg-type, reportArgumentType
        self.status.publish(
            DiagnosticStatus(name="pilot", mesage="")
        )  # refused: arg-type, reportArgumentType
        print(point.speed)  # refused: attr-defined, reportAttributeAccessIssue

    async def drive_slowly(self, point: Point) -> None:
        self.drive(point)

    def drive_when_new(self, point: Point, info: dict[str, Any]) -> None:
        self.get_logger().info(f"{point.x} at {info['source_timestamp']}")
        self.get_logger().info(point.x)  # refused: arg-type, reportArgumentType

    def record(self, data: bytes) -> None:
        print(len(data))

    def record_with_info(self, data: bytes, info: dict[str, Any]) -> None:
        print(len(data), info)

    def publish_status(self) -> None:
        self.status.publish(DiagnosticStatus(name="pilot"))
        self.beat.period = 0.2  # refused: attr-defined, reportAttributeAccessIssue

    async def publish_status_slowly(self) -> None:
        self.publish_status()


def topic_of(endpoint: Publisher | Subscription) -> str:
    """Endpoints without parameters, as programs have written them, are those of any message."""
    return endpoint.topic_name


def main() -> None:
    rclpy.init()
    pilot = Pilot()
    executor = SingleThreadedExecutor()
    executor.add_node(pilot)
    print(topic_of(pilot.commands), topic_of(pilot.goals))
    rclpy.spin(pilot, executor)
    rclpy.spin(Pilot)  # refused: arg-type, reportArgumentType
    rclpy.spinn(pilot)  # refused: attr-defined, reportAttributeAccessIssue
    executor.add_nodes([pilot])  # refused: attr-defined, reportAttributeAccessIssue
    rclpy.shutdown()
