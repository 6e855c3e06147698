"""Topics: strings, headers, nested messages, arrays, every basic type, a latched one and a hidden one."""

from __future__ import annotations

from functools import partial
from typing import Any

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import String, UInt8MultiArray
from test_msgs.msg import BasicTypes, WStrings

from tests.tools.scenes.stage import play

STAMP = Time(sec=1234567890, nanosec=5)


def messages() -> dict[str, Any]:
    """What is sent again and again, by topic."""
    pose = PoseStamped()
    pose.header.stamp, pose.header.frame_id = STAMP, "map"
    pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.w = 0.1, -2.0, 1.0
    joints = JointState(name=["hip", "knee"], position=[0.1, 1e-9], velocity=[1e20, float("nan")])
    joints.header.stamp = STAMP
    basic = BasicTypes(
        bool_value=True, byte_value=b"\xff", char_value=100, float32_value=0.1, float64_value=0.1
    )
    basic.int8_value, basic.uint8_value, basic.int64_value, basic.uint64_value = -1, 255, -(2**63), 2**64 - 1
    return {
        "chatter": String(data="hello: 'world' #1"),
        "pose": pose,
        "joints": joints,
        "basic": basic,
        "blob": UInt8MultiArray(data=[n % 256 for n in range(300)]),
        "long": String(data="x" * 200),
        "wide": WStrings(wstring_value="Grüße"),
        "_secret": String(data="hidden"),
    }


def main() -> None:
    """Send each message ten times a second."""
    rclpy.init()
    talker, listener = Node("talker"), Node("listener", namespace="/demo")
    for topic, message in messages().items():
        publisher = talker.create_publisher(type(message), topic, 10)
        talker.create_timer(0.1, partial(publisher.publish, message))
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    talker.create_publisher(String, "latched", latched).publish(String(data="sent before you came"))
    imu = talker.create_publisher(Imu, "imu", qos_profile_sensor_data)

    def measure() -> None:
        message = Imu()
        message.header.stamp = talker.get_clock().now().to_msg()
        imu.publish(message)

    talker.create_timer(0.02, measure)
    listener.create_subscription(String, "/chatter", lambda _: None, 10)
    listener.create_subscription(Twist, "command", lambda _: None, 10)
    play(talker, listener)


if __name__ == "__main__":
    main()
