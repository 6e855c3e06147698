"""Offer a service and an action on asyncio.

ifgen run examples/async_nodes/server.py : examples/async_nodes/client.py
"""

import asyncio
import contextlib
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from humanoid_interfaces.srv import AddTwoInts
from rclpy.action import CancelResponse
from rclpy_asyncio import AsyncNode


class Server(AsyncNode):
    """Offers `add_two_ints` and `fibonacci`."""

    def __init__(self) -> None:
        super().__init__("async_server")
        self.create_service(AddTwoInts, "add_two_ints", self.on_request, concurrent=True)
        self.create_action_server(
            Fibonacci, "fibonacci", self.execute, cancel_callback=lambda goal: CancelResponse.ACCEPT
        )

    async def on_request(
        self, request: AddTwoInts.Request, response: AddTwoInts.Response
    ) -> AddTwoInts.Response:
        """Answer with the sum, after a while; other requests are answered meanwhile."""
        await asyncio.sleep(0.01)
        response.sum = request.a + request.b
        return response

    async def execute(self, goal: Any) -> Fibonacci.Result:
        """Compute a number every 20 ms."""
        sequence = [0, 1]
        try:
            while len(sequence) <= goal.request.order:
                await asyncio.sleep(0.02)
                sequence.append(sequence[-1] + sequence[-2])
                goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        except asyncio.CancelledError:  # the goal was cancelled
            self.get_logger().info("cancelled")
            raise
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)


def main(args: list[str] | None = None) -> None:
    """Run until Ctrl-C."""
    rclpy.init(args=args)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(Server().run())
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
