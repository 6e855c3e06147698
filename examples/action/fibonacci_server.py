"""Compute Fibonacci numbers, one at a time, for whoever asks.

`ifgen run examples/action/fibonacci_server.py : examples/action/fibonacci_client.py 10`.
"""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node

STEP = 0.1  # [s] between two numbers


class FibonacciServer(Node):
    """Offers the action `fibonacci`: feedback after each number, cancellable at any time."""

    def __init__(self) -> None:
        super().__init__("fibonacci_server")
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
            # Cancel requests must be handled while goals execute.
            callback_group=ReentrantCallbackGroup(),
        )

    def on_goal(self, goal: Fibonacci.Goal) -> GoalResponse:
        """Accept the orders that can be computed."""
        self.get_logger().info(f"asked for order {goal.order}")
        return GoalResponse.ACCEPT if 0 <= goal.order <= 46 else GoalResponse.REJECT

    def on_cancel(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """Let every goal be cancelled."""
        return CancelResponse.ACCEPT

    def execute(self, goal_handle: ServerGoalHandle) -> Fibonacci.Result:
        """Compute the numbers 0 to `order`, until the goal is cancelled."""
        feedback = Fibonacci.Feedback(sequence=[0, 1][: goal_handle.request.order + 1])
        while len(feedback.sequence) <= goal_handle.request.order:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                self.get_logger().info("canceled")
                return Fibonacci.Result(sequence=feedback.sequence)
            feedback.sequence.append(feedback.sequence[-2] + feedback.sequence[-1])
            goal_handle.publish_feedback(feedback)
            time.sleep(STEP)
        goal_handle.succeed()
        self.get_logger().info("succeeded")
        return Fibonacci.Result(sequence=feedback.sequence)

    def destroy_node(self) -> None:
        """End the action as well."""
        self.server.destroy()
        super().destroy_node()


def main(args: list[str] | None = None) -> None:
    """Run until Ctrl-C; several goals can execute at a time."""
    rclpy.init(args=args)
    node = FibonacciServer()
    try:
        rclpy.spin(node, executor=MultiThreadedExecutor(num_threads=4))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
