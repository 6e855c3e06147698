"""A user's node with both ends of an action."""

from __future__ import annotations

from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future
from tf2_msgs.action import LookupTransform


class Counter(Node):
    """Computes Fibonacci numbers, and asks for them."""

    def __init__(self) -> None:
        super().__init__("counter")
        self.server: ActionServer[Fibonacci] = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            goal_callback=self.accept,
            handle_accepted_callback=self.begin,
            cancel_callback=self.cancel,
        )
        self.slow_server = ActionServer(
            self, Fibonacci, "fibonacci_slowly", execute_callback=self.execute_slowly
        )
        self.client: ActionClient[Fibonacci] = ActionClient(self, Fibonacci, "fibonacci")
        self.transforms = ActionClient(self, LookupTransform, "transforms")

        ActionServer(self, Fibonacci, "x", self.execute_nothing)  # refused: arg-type, reportArgumentType
        ActionServer(self, LookupTransform, "x", self.execute)  # refused: arg-type, reportArgumentType
        ActionServer(
            self, Fibonacci, "x", self.execute, goal_callback=self.execute
        )  # refused: arg-type, reportArgumentType
        ActionServer(
            self, Fibonacci, "x", self.execute, cancel_callback=self.accept
        )  # refused: arg-type, reportArgumentType
        ActionServer(self, Fibonacci.Goal, "x", self.execute)  # refused: arg-type, reportArgumentType
        ActionClient(self, Fibonacci.Goal, "x")  # refused: type-var, reportArgumentType

    def accept(self, goal: Fibonacci.Goal) -> GoalResponse:
        return GoalResponse.ACCEPT if goal.order < 46 else GoalResponse.REJECT

    def begin(self, goal_handle: ServerGoalHandle[Fibonacci]) -> None:
        goal_handle.execute()

    async def cancel(self, goal_handle: ServerGoalHandle[Fibonacci]) -> CancelResponse:
        return CancelResponse.ACCEPT

    def execute(self, goal_handle: ServerGoalHandle[Fibonacci]) -> Fibonacci.Result:
        numbers = [0, 1]
        for _ in range(goal_handle.request.order):
            numbers.append(numbers[-1] + numbers[-2])
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()

        print(goal_handle.request.number)  # refused: attr-defined, reportAttributeAccessIssue
        goal_handle.publish_feedback(Fibonacci.Result())  # refused: arg-type, reportArgumentType
        goal_handle.publish_feedback(numbers)  # refused: arg-type, reportArgumentType
        goal_handle.succeed(Fibonacci.Feedback())  # refused: arg-type, reportArgumentType
        return Fibonacci.Result(sequence=numbers)

    async def execute_slowly(self, goal_handle: ServerGoalHandle[Fibonacci]) -> Fibonacci.Result:
        return self.execute(goal_handle)

    def execute_nothing(self, goal_handle: ServerGoalHandle[Fibonacci]) -> None:
        goal_handle.abort()

    def ask(self) -> None:
        future = self.client.send_goal_async(Fibonacci.Goal(order=10), feedback_callback=self.hear)
        future.add_done_callback(self.wait)
        self.client.send_goal_async(
            Fibonacci.Goal(order=10), feedback_callback=lambda message: print(message.feedback.sequence)
        )
        print(self.client.send_goal(Fibonacci.Goal(order=3), feedback_callback=self.hear).result.sequence)

        self.client.send_goal_async(Fibonacci.Result())  # refused: arg-type, reportArgumentType
        self.client.send_goal(3)  # refused: arg-type, reportArgumentType
        self.transforms.send_goal_async(Fibonacci.Goal())  # refused: arg-type, reportArgumentType
        self.client.send_goal_async(
            Fibonacci.Goal(), feedback_callback=self.hear_bare
        )  # refused: arg-type, reportArgumentType

    def hear(self, message: Fibonacci.Impl.FeedbackMessage) -> None:
        print(message.feedback.sequence)

    def hear_bare(self, feedback: Fibonacci.Feedback) -> None:
        print(feedback.sequence)

    def wait(self, future: Future[ClientGoalHandle[Fibonacci]]) -> None:
        goal_handle = future.result()
        if goal_handle.accepted:
            goal_handle.get_result_async().add_done_callback(self.finish)
        print(goal_handle.acepted)  # refused: attr-defined, reportAttributeAccessIssue

    def finish(self, future: Future[Fibonacci.Impl.GetResultService.Response]) -> None:
        response = future.result()
        print(response.status, response.result.sequence)
        print(response.sequence)  # refused: attr-defined, reportAttributeAccessIssue

    async def ask_and_wait(self) -> list[int]:
        goal_handle = await self.client.send_goal_async(Fibonacci.Goal(order=10))
        response = await goal_handle.get_result_async()
        cancelled = await goal_handle.cancel_goal_async()
        print(len(cancelled.goals_canceling), goal_handle.stamp.sec, goal_handle.goal_id.uuid)
        print(response.result.numbers)  # refused: attr-defined, reportAttributeAccessIssue
        return list(response.result.sequence)
