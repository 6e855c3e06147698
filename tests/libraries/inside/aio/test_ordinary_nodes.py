"""Ordinary nodes on an event loop: asyncio works in their callbacks, and so does what they are used to."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from humanoid_interfaces.srv import FollowPath, PlanFootsteps
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from rclpy_asyncio import AsyncNode, spin, wrap_future
from std_msgs.msg import Int32

from tests.libraries.inside.aio.conftest import eventually, on_loop, turns


@asynccontextmanager
async def _spinning(node: Node) -> AsyncIterator[asyncio.Task[None]]:
    task = asyncio.create_task(spin(node))
    await turns(2)
    yield task
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    node.destroy_node()


@on_loop
async def test_asyncio_in_every_callback(name: str) -> None:
    """Subscription, service and timer may sleep as asyncio does, and await a client's future as rclpy does."""
    node = Node(name)
    done: list[str] = []

    async def on_message(message: Any) -> None:
        await asyncio.sleep(0.001)
        response = await client.call_async(AddTwoInts.Request(a=message.data, b=2))
        done.append(f"sum {response.sum}")

    async def add(request: Any, response: Any) -> Any:
        await asyncio.gather(asyncio.sleep(0.001), asyncio.sleep(0))
        response.sum = request.a + request.b
        return response

    async def tick() -> None:
        async with asyncio.TaskGroup() as group:
            group.create_task(asyncio.sleep(0.001))
        done.append("tick")
        timer.cancel()

    group = ReentrantCallbackGroup()
    node.create_subscription(Int32, name, on_message, 10, callback_group=group)
    node.create_service(AddTwoInts, name, add, callback_group=group)
    client = node.create_client(AddTwoInts, name, callback_group=group)
    timer = node.create_timer(0.001, tick)
    publisher = node.create_publisher(Int32, name, 10)
    async with _spinning(node):
        await eventually(client.service_is_ready)
        await eventually(publisher.get_subscription_count)
        publisher.publish(Int32(data=1))
        await eventually(lambda: len(done) == 2)
    assert sorted(done) == ["sum 3", "tick"]


@pytest.mark.parametrize("exclusive", [True, False])
@on_loop
async def test_callback_groups(name: str, exclusive: bool) -> None:
    """Callbacks of an exclusive group never overlap, also when they await."""
    now = most = calls = 0
    node = Node(name)

    async def count(message: Any) -> None:
        nonlocal now, most, calls
        now += 1
        most = max(most, now)
        await turns(2)
        now -= 1
        calls += 1

    group = MutuallyExclusiveCallbackGroup() if exclusive else ReentrantCallbackGroup()
    for _ in range(2):
        node.create_subscription(Int32, name, count, 10, callback_group=group)
    publisher = node.create_publisher(Int32, name, 10)
    async with _spinning(node):
        await eventually(lambda: publisher.get_subscription_count() == 2)
        publisher.publish(Int32())
        publisher.publish(Int32())
        await eventually(lambda: calls == 4)
    assert (most == 1) is exclusive


@on_loop
async def test_ordinary_actions(name: str) -> None:
    """Client and server of an action, as rclpy has them."""
    node = Node(name)

    async def execute(goal: Any) -> Any:
        await asyncio.sleep(0.001)
        goal.succeed()
        return Fibonacci.Result(sequence=[goal.request.order])

    server = ActionServer(node, Fibonacci, name, execute)
    client = ActionClient(node, Fibonacci, name)
    async with _spinning(node):
        await eventually(client.server_is_ready)
        handle = await wrap_future(client.send_goal_async(Fibonacci.Goal(order=4)))
        response = await wrap_future(handle.get_result_async())
        assert list(response.result.sequence) == [4]
        server.destroy()
        client.destroy()


@on_loop
async def test_guard_conditions(name: str) -> None:
    """Another thread triggers it."""
    node = Node(name)
    called = asyncio.Event()
    guard = node.create_guard_condition(called.set)
    async with _spinning(node):
        threading.Thread(target=guard.trigger).start()
        await called.wait()


@on_loop
async def test_an_exception_of_a_callback() -> None:
    """It ends `spin` in an ExceptionGroup."""
    node = Node("fails")

    def fail() -> None:
        raise ValueError("of the timer")

    node.create_timer(0.001, fail)
    with pytest.raises(ExceptionGroup) as caught:
        await spin(node)
    assert caught.group_contains(ValueError, match="of the timer")
    node.destroy_node()


@on_loop
async def test_shutdown_ends_spin(name: str) -> None:
    """As it ends `rclpy.spin`."""
    node = Node(name)
    task = asyncio.create_task(spin(node))
    await turns(2)
    rclpy.shutdown()
    await task


@on_loop
async def test_an_executor_afterwards(name: str) -> None:
    """The node may be given to an executor, but not while it runs here."""
    node = Node(name)
    calls: list[None] = []
    node.create_timer(0.001, lambda: calls.append(None))
    executor = SingleThreadedExecutor()
    task = asyncio.create_task(spin(node))
    await eventually(lambda: calls)
    with pytest.raises(RuntimeError, match="runs on an event loop: no executor can have it"):
        executor.add_node(node)
    executor.remove_node(node)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    count = len(calls)
    executor.add_node(node)
    while len(calls) == count:
        executor.spin_once(timeout_sec=5)
    executor.shutdown()
    node.destroy_node()


@pytest.mark.parametrize("fails", [True, False])
@on_loop
async def test_futures_of_other_threads(name: str, fails: bool) -> None:
    """`wrap_future` waits for them, whoever completes them."""
    future: Future[int] = Future()
    threading.Timer(
        0.01, lambda: future.set_exception(KeyError("k")) if fails else future.set_result(5)
    ).start()
    if fails:
        with pytest.raises(KeyError):
            await wrap_future(future)
    else:
        assert await wrap_future(future) == 5


def _planner() -> Any:
    """A node of a generated package, of the style `asyncio`."""
    from footstep_planner._footstep_planner_base import FootstepPlannerBase

    class Planner(FootstepPlannerBase):
        async def on_teleop_velocity(self, message: Any) -> None:
            pass

        async def on_map(self, message: Any) -> None:
            pass

        async def on_gait_state(self, message: Any) -> None:
            pass

        async def handle_follow_path(self, request: Any, response: Any) -> Any:
            await asyncio.gather(asyncio.sleep(0.001), asyncio.sleep(0.001))
            await self.sleep(0.01)
            planned = await self.call_plan_footsteps(PlanFootsteps.Request())
            response.message = f"planned: {planned.message}"
            return response

    return Planner()


@on_loop
async def test_generated_nodes(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Both asyncio and the methods that the base class has work in their callbacks."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[4] / "generated/footstep_planner"))

    def plan(request: Any, response: Any) -> Any:
        response.message = "no"
        return response

    async with AsyncNode(name) as node, _spinning(_planner()):
        node.create_service(PlanFootsteps, "/plan_footsteps", plan)
        client = node.create_client(FollowPath, "/follow_path")
        await client.wait_for_service()
        assert (await client.call(FollowPath.Request())).message == "planned: no"
