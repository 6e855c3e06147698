"""A publisher and a subscription in one node: the smallest conversation there is."""

import rclpy
from std_msgs.msg import String
from transcript import until


def main() -> None:
    """Three messages, published one by one, arrive in order."""
    rclpy.init()
    node = rclpy.create_node("talker")
    heard: list[str] = []
    node.create_subscription(String, "chatter", lambda message: heard.append(message.data), 10)
    publisher = node.create_publisher(String, "chatter", 10)
    print(until(lambda: publisher.get_subscription_count() == 1, node))
    for number in range(3):
        publisher.publish(String(data=f"hello {number}"))
        print(until(lambda count=number + 1: len(heard) == count, node), heard[-1:])
    node.destroy_node()
    rclpy.shutdown()
