"""Ask `add_two_ints` for a sum.

ifgen run examples/services/server.py : examples/services/client.py 41 1
"""

import sys

import rclpy
from humanoid_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.task import Future
from rclpy.utilities import remove_ros_args


class AddTwoIntsClient(Node):
    """Asks the service `add_two_ints`."""

    def __init__(self) -> None:
        super().__init__("add_two_ints_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("service not available, waiting again...")

    def send_request(self, a: int, b: int) -> Future:
        """Send the request; the future holds the response once it has arrived."""
        return self.client.call_async(AddTwoInts.Request(a=a, b=b))


def main(args: list[str] | None = None) -> None:
    """Ask for the sum of the two numbers on the command line."""
    rclpy.init(args=args)
    a, b = (int(number) for number in remove_ros_args(sys.argv)[1:3])
    node = AddTwoIntsClient()
    try:
        future = node.send_request(a, b)
        while rclpy.ok() and not future.done():
            rclpy.spin_once(node)
        node.get_logger().info(f"{a} + {b} = {future.result().sum}")
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
