"""Publish a line of text twice a second.

ifgen run examples/topics/publisher.py : examples/topics/subscriber.py
"""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class MinimalPublisher(Node):
    """Publishes std_msgs/String on `my_topic`, driven by a timer."""

    def __init__(self) -> None:
        super().__init__("minimal_publisher")
        self.publisher = self.create_publisher(String, "my_topic", 10)
        self.timer = self.create_timer(0.5, self.on_timer)
        self.count = 0

    def on_timer(self) -> None:
        """Publish the next line."""
        message = String(data=f"Hello, robot: {self.count}")
        self.publisher.publish(message)
        self.get_logger().info(f"publishing {message.data!r}")
        self.count += 1


def main(args: list[str] | None = None) -> None:
    """Run until Ctrl-C."""
    rclpy.init(args=args)
    node = MinimalPublisher()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
