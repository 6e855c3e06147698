"""Payloads that are no messages: dropped, and the node goes on."""

from common import never_compiled, rclpy, spin_until
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

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
node.destroy_node()
rclpy.shutdown()
