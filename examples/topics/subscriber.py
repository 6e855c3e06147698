"""Print what arrives on `my_topic`.

ifgen run examples/topics/publisher.py : examples/topics/subscriber.py
"""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class MinimalSubscriber(Node):
    """Listens to std_msgs/String on `my_topic`."""

    def __init__(self) -> None:
        super().__init__("minimal_subscriber")
        self.subscription = self.create_subscription(String, "my_topic", self.on_message, 10)

    def on_message(self, message: String) -> None:
        """Print a message."""
        self.get_logger().info(f"I heard {message.data!r}")


def main(args: list[str] | None = None) -> None:
    """Run until Ctrl-C."""
    rclpy.init(args=args)
    node = MinimalSubscriber()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
