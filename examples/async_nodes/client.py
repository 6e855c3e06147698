"""Ask for three sums at the same time, and for numbers until there are enough of them.

ifgen run examples/async_nodes/server.py : examples/async_nodes/client.py
"""

import asyncio

import rclpy
from example_interfaces.action import Fibonacci
from humanoid_interfaces.srv import AddTwoInts
from rclpy_asyncio import AsyncNode


async def run() -> None:
    """Ask, and say what came."""
    async with AsyncNode("async_client") as node, asyncio.timeout(20):
        log = node.get_logger()
        add = node.create_client(AddTwoInts, "add_two_ints")
        fibonacci = node.create_action_client(Fibonacci, "fibonacci")
        await asyncio.gather(add.wait_for_service(), fibonacci.wait_for_server())

        calls = [add.call(AddTwoInts.Request(a=number, b=1)) for number in range(3)]
        log.info(f"sums: {[response.sum for response in await asyncio.gather(*calls)]}")

        response = await fibonacci.send_goal(Fibonacci.Goal(order=5))
        log.info(f"result: {list(response.result.sequence)}")

        async with fibonacci.goal(Fibonacci.Goal(order=1000)) as goal:
            async for feedback in goal.feedback():
                if feedback.sequence[-1] > 10:
                    break  # leaving the block cancels the goal
        log.info(f"enough: {feedback.sequence[-1]}")

        try:
            async with asyncio.timeout(0.1):  # and so does a deadline
                await fibonacci.send_goal(Fibonacci.Goal(order=1000))
        except TimeoutError:
            log.info("too slow")


def main(args: list[str] | None = None) -> None:
    """Run to the end."""
    rclpy.init(args=args)
    asyncio.run(run())
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
