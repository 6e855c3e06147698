"""A user's node with parameters, time and logging: what strict type checkers accept, and what they refuse."""

from __future__ import annotations

import sys

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rclpy.time import Time
from std_msgs.msg import String


class Heater(Node):
    """Heats as its parameters say."""

    def __init__(self) -> None:
        super().__init__("heater", namespace="/kitchen", parameter_overrides=[Parameter("limit", value=0.1)])
        limits = ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=0.0, to_value=0.9)])
        self.limit: float = self.declare_parameter("limit", 0.1, limits).get_parameter_value().double_value
        self.declare_parameters("pid", [("p", 0.3), ("i", 0.1), ("d", 0.0, limits), ("name", "main")])
        gains = [("a", 0.1), ("b", 0.2)]
        self.declare_parameters("", gains)
        self.declare_parameter("mode", Parameter.Type.STRING)
        self.add_on_set_parameters_callback(self.on_change)
        self.started: Time = self.get_clock().now()
        self.clock: Clock = self.get_clock()
        self.group = ReentrantCallbackGroup()
        latched = QoSProfile(
            depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )
        self.notes = self.create_publisher(String, "notes", latched, callback_group=self.group)
        self.create_subscription(String, "words", print, qos_profile_sensor_data)

        self.declare_parameter(0.1)  # refused: arg-type, reportArgumentType
        self.declare_parameters("", [0.1])  # refused: list-item, reportArgumentType
        self.limit = self.get_parameter("limit")  # refused: assignment, reportAttributeAccessIssue
        self.create_publisher(String, "x", 1, callback_group="g")  # refused: arg-type, reportArgumentType
        self.add_on_set_parameters_callback(self.say)  # refused: arg-type, reportArgumentType
        super().__init__("heater", context="x")  # refused: arg-type, reportArgumentType

    def on_change(self, parameters: list[Parameter]) -> SetParametersResult:
        for each in parameters:
            if each.name == "limit" and each.type_ is Parameter.Type.DOUBLE:
                self.limit = each.value
        self.set_parameters([Parameter("pid.p", Parameter.Type.DOUBLE, 0.4)])
        self.set_parameters(["pid.p"])  # refused: list-item, reportArgumentType
        return SetParametersResult(successful=True, reason="")

    def say(self) -> None:
        age: Duration = self.clock.now() - self.started
        if age > Duration(seconds=0.1) and self.has_parameter("limit"):
            self.get_logger().info(f"{age.nanoseconds} ns", throttle_duration_sec=1.0)
            self.get_logger().warning("late", once=True)
        self.get_logger().inform("late")  # refused: attr-defined, reportAttributeAccessIssue
        self.get_logger().info(age)  # refused: arg-type, reportArgumentType
        age + 1  # refused: operator, reportOperatorIssue
        Duration(seconds="1")  # refused: arg-type, reportArgumentType


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = Heater()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    executor.add_node("heater")  # refused: arg-type, reportArgumentType
    try:
        rclpy.spin(node, executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv)
