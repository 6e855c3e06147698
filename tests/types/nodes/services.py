"""A user's node with services and clients, futures and tasks."""

from __future__ import annotations

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.client import Client
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.service import Service
from rclpy.task import Future, Task
from std_srvs.srv import Trigger


class Calculator(Node):
    """Adds, and asks another one to add."""

    def __init__(self) -> None:
        super().__init__("calculator")
        self.adding: Service[AddTwoInts] = self.create_service(AddTwoInts, "add", self.add)
        self.create_service(AddTwoInts, "add_slowly", self.add_slowly)
        self.create_service(Trigger, "reset", lambda request, response: response)
        self.adder: Client[AddTwoInts] = self.create_client(AddTwoInts, "add")
        self.resetter = self.create_client(Trigger, "reset")

        self.create_client(int, "x")  # refused: type-var, reportArgumentType
        self.create_client(AddTwoInts.Request, "x")  # refused: type-var, reportArgumentType
        self.create_service(int, "x", self.add)  # refused: arg-type, reportArgumentType
        self.create_service(Trigger, "x", self.add)  # refused: arg-type, reportArgumentType
        self.create_service(AddTwoInts, "x", self.add_nothing)  # refused: arg-type, reportArgumentType
        self.create_service(
            AddTwoInts, "x", self.add_by_one_argument
        )  # refused: arg-type, reportArgumentType
        self.wrong: Client[Trigger] = self.create_client(
            AddTwoInts, "x"
        )  # refused: arg-type, reportAttributeAccessIssue

    def add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        response.sum = request.c  # refused: attr-defined, reportAttributeAccessIssue
        response.sum = str(request.a)  # refused: assignment, reportAttributeAccessIssue
        return response

    async def add_slowly(
        self, request: AddTwoInts.Request, response: AddTwoInts.Response
    ) -> AddTwoInts.Response:
        answer = await self.adder.call_async(request)
        response.sum = answer.sum
        print(answer.success)  # refused: attr-defined, reportAttributeAccessIssue
        return response

    def add_nothing(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> None:
        """Forgets to return the response."""

    def add_by_one_argument(self, request: AddTwoInts.Request) -> AddTwoInts.Response:
        return AddTwoInts.Response(sum=request.a)

    def ask(self) -> int:
        future: Future[AddTwoInts.Response] = self.adder.call_async(AddTwoInts.Request(a=1, b=2))
        future.add_done_callback(self.hear)
        future.add_done_callback(lambda done: print(done.result().sum))
        future.add_done_callback(self.hear_whatever)
        answer = self.adder.call(AddTwoInts.Request(a=1, b=2))
        perhaps = self.adder.call(AddTwoInts.Request(a=1, b=2), timeout_sec=1.0)

        self.adder.call_async(3)  # refused: arg-type, reportArgumentType
        self.adder.call_async(AddTwoInts.Response())  # refused: arg-type, reportArgumentType
        self.resetter.call(AddTwoInts.Request())  # refused: call-overload, reportArgumentType
        print(perhaps.sum)  # refused: union-attr, reportOptionalMemberAccess
        future.add_done_callback(self.add)  # refused: arg-type, reportArgumentType
        future.add_done_callback(self.hear_reset)  # refused: arg-type, reportArgumentType
        future.set_result(3)  # refused: arg-type, reportArgumentType
        if perhaps is not None:
            print(perhaps.sum)
        return answer.sum

    def hear(self, future: Future[AddTwoInts.Response]) -> None:
        print(future.result().sum)
        print(future.result().total)  # refused: attr-defined, reportAttributeAccessIssue

    def hear_whatever(self, future: Future) -> None:
        print(future.result())

    def hear_reset(self, future: Future[Trigger.Response]) -> None:
        print(future.result().success)


def half(number: int) -> float:
    return number / 2


async def third(number: int) -> float:
    return number / 3


def main() -> None:
    rclpy.init()
    node = Calculator()
    executor = MultiThreadedExecutor(num_threads=2)
    one: Task[float] = executor.create_task(half, 3)
    other: Task[float] = executor.create_task(third, 3)
    started: Task[float] = executor.create_task(third(3))
    print(one.result() + other.result() + started.result())
    executor.spin_until_future_complete(one)
    rclpy.spin_until_future_complete(node, node.adder.call_async(AddTwoInts.Request()), timeout_sec=1.0)

    wrong: Task[str] = executor.create_task(half, 3)  # refused: call-overload, reportAssignmentType
    executor.create_task(half, "3")  # refused: call-overload, reportArgumentType
    rclpy.spin_until_future_complete(node, half)  # refused: arg-type, reportArgumentType
    rclpy.spin_until_future_complete(node)  # refused: call-arg, reportCallIssue
    print(wrong)
