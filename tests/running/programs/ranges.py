"""Publishes a value outside its range and receives it: IFGEN_CHECK_FIELDS says so on both sides."""

import time

import rclpy
from meant_msgs.msg import Wheel

rclpy.init()
node = rclpy.create_node("wheel")
received: list[float] = []
node.create_subscription(Wheel, "wheel", lambda message: received.append(message.speed), 10)
publisher = node.create_publisher(Wheel, "wheel", 10)
end = time.monotonic() + 20
while not received and time.monotonic() < end:
    publisher.publish(Wheel(speed=4.5))
    rclpy.spin_once(node, timeout_sec=0.1)
print(received[0])
rclpy.shutdown()
