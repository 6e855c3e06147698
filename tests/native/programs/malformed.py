"""Payloads that are not messages are dropped, and the node goes on."""

import time

from common import never_compiled, rclpy, spin_until
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("malformed")
received: list[JointState] = []
node.create_subscription(never_compiled("sensor_msgs/msg/JointState"), "joints", received.append, 100)
publisher = node.create_publisher(JointState, "joints", 100)
spin_until(node, publisher.get_subscription_count)
good = serialize_message(JointState(name=["a"], position=[1.0]))
for payload in (
    good[:22],
    good[:4] + bytes(8) + b"\xff\xff\xff\x7f",
    good[:4],
    b"\x00\x01\x00\x00" + b"\xff" * 300,
    b"\x00\x03" + good[2:],
):
    publisher.publish(payload)
big_endian = b"\x00\x00\x00\x00" + bytes(8) + b"\x00\x00\x00\x01\x00\x00\x00\x00" + bytes(16)
publisher.publish(big_endian)
publisher.publish(good)
spin_until(node, lambda: len(received) == 2)
print([list(message.name) for message in received])
# A peer that sends only these, of two types in turn, one of them with headers that Fast CDR itself refuses.
node.create_subscription(never_compiled("std_msgs/msg/String"), "texts", received.append, 100)
texts = node.create_publisher(String, "texts", 100)
spin_until(node, texts.get_subscription_count)
for _ in range(500):
    texts.publish(good[:4] + b"\xff" * 8)
    publisher.publish(b"\x00\x77" + good[2:])
    rclpy.spin_once(node, timeout_sec=0)
    rclpy.spin_once(node, timeout_sec=0)
time.sleep(1)  # the thread that counts looks four times a second
node.destroy_node()
rclpy.shutdown()
