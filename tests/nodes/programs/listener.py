"""Ends as soon as it has heard a joint."""

import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from robot.msg import Joint

rclpy.init()
node = rclpy.create_node("listener")
heard: list[Joint] = []
node.create_subscription(
    Joint, "joint", heard.append, QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
)
while not heard:
    rclpy.spin_once(node, timeout_sec=0.1)
print("heard", heard[0])
node.destroy_node()
rclpy.shutdown()
