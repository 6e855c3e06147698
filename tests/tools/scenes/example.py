"""What the examples in the help of the commands name."""

from __future__ import annotations

from functools import partial
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import PoseStamped, Twist
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionServer
from rclpy.action.server import ServerGoalHandle
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState
from sensor_msgs.msg import Image, Imu, LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool

from tests.tools.scenes.stage import play


def count(goal: ServerGoalHandle) -> Fibonacci.Result:
    """Succeed at once."""
    goal.succeed()
    return Fibonacci.Result(sequence=[0, 1, 1])


def send(publisher: Any, message: Any) -> None:
    """Publish a message, stamped with the time of now if it has a header."""
    if hasattr(message, "header"):
        message.header.stamp = Clock(clock_type=ClockType.ROS_TIME).now().to_msg()
    publisher.publish(message)


def main() -> None:
    """Send, serve and wait."""
    rclpy.init()
    talker = Node("talker")
    talker.declare_parameter(
        "speed", 0.1, ParameterDescriptor(dynamic_typing=True)
    )  # so that it can be deleted
    steady = Clock(clock_type=ClockType.STEADY_TIME)  # goes on when an example sets use_sim_time
    for topic, message in (
        ("chatter", String(data="hello")),
        ("pose", PoseStamped()),
        ("imu", Imu()),
        ("scan", LaserScan(ranges=[1.0, 2.0])),
        ("camera/image", Image(height=2, width=2, step=2, encoding="mono8", data=bytes(4))),
    ):
        publisher = talker.create_publisher(type(message), topic, 10)
        talker.create_timer(0.05, partial(send, publisher, message), clock=steady)
    talker.create_subscription(Twist, "cmd_vel", lambda _: None, 10)
    talker.create_service(SetBool, "switch", agree)
    add = talker.create_service(AddTwoInts, "add", plus)
    add.configure_introspection(
        talker.get_clock(), qos_profile_services_default, ServiceIntrospectionState.CONTENTS
    )
    caller = talker.create_client(AddTwoInts, "add")
    talker.create_timer(0.5, lambda: caller.call_async(AddTwoInts.Request(a=1, b=2)), clock=steady)
    servers = [ActionServer(talker, Fibonacci, name, count) for name in ("walk", "count")]
    play(talker, LifecycleNode("camera_driver"))
    for server in servers:
        server.destroy()


def plus(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    """Add."""
    response.sum = request.a + request.b
    return response


def agree(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    """Agree."""
    response.success = request.data
    return response


if __name__ == "__main__":
    main()
