"""Ask for Fibonacci numbers; a second argument cancels after that number of feedback messages.

`ifgen run examples/action/fibonacci_server.py : examples/action/fibonacci_client.py 10 [3]`.
"""

import sys

import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from rclpy.utilities import remove_ros_args

STATUS_NAMES = {
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "canceled",
    GoalStatus.STATUS_ABORTED: "aborted",
}


class FibonacciClient(Node):
    """Sends one goal to the action `fibonacci` and reports what happens to it."""

    def __init__(self, cancel_after: int | None) -> None:
        super().__init__("fibonacci_client")
        self.client = ActionClient(self, Fibonacci, "fibonacci")
        self.cancel_after = cancel_after
        self.goal_handle: ClientGoalHandle | None = None
        self.heard = 0

    def send_goal(self, order: int) -> None:
        """Wait for the server and send the goal; the rest happens in callbacks."""
        while not self.client.wait_for_server(timeout_sec=1.0):
            self.get_logger().info("action server not available, waiting again...")
        future = self.client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.on_feedback)
        future.add_done_callback(self.on_response)

    def on_response(self, future: Future) -> None:
        """Ask for the result if the goal was accepted."""
        self.goal_handle = future.result()
        if not self.goal_handle.accepted:
            self.get_logger().info("rejected")
            rclpy.shutdown()
            return
        self.get_logger().info("accepted")
        self.goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_feedback(self, message: Fibonacci.Impl.FeedbackMessage) -> None:
        """Report the numbers computed so far."""
        self.get_logger().info(f"so far {list(message.feedback.sequence)}")
        self.heard += 1
        if self.heard == self.cancel_after and self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()

    def on_result(self, future: Future) -> None:
        """Report the result and end the program."""
        response = future.result()
        self.get_logger().info(f"{STATUS_NAMES[response.status]}: {list(response.result.sequence)}")
        rclpy.shutdown()


def main(args: list[str] | None = None) -> None:
    """Ask for the given number of Fibonacci numbers."""
    rclpy.init(args=args)
    order, *rest = (int(number) for number in remove_ros_args(sys.argv)[1:3])
    node = FibonacciClient(rest[0] if rest else None)
    try:
        node.send_goal(order)
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.client.destroy()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
