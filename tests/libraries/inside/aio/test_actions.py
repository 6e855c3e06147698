"""Actions of an AsyncNode: goals are awaited, and cancelling a task cancels its goal."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from ifgen_runtime.errors import ServerGoneError
from rclpy.action import CancelResponse, GoalResponse
from rclpy.qos import QoSProfile
from rclpy_asyncio import AsyncActionClient, AsyncActionServer, AsyncNode, GoalRejectedError
from unique_identifier_msgs.msg import UUID

from tests.libraries.inside.aio.conftest import eventually, on_loop, turns

Execute = Callable[[Any], Awaitable[Any]]


@dataclass
class _Pair:
    node: AsyncNode
    client: AsyncActionClient
    server_node: AsyncNode
    server: AsyncActionServer


@asynccontextmanager
async def _pair(
    name: str, execute: Any, *, depth: int = 10, accepts_cancel: bool = True, **options: Any
) -> AsyncIterator[_Pair]:
    """A client and a server of an action, each on a node of its own."""
    if accepts_cancel:
        options.setdefault("cancel_callback", lambda goal: CancelResponse.ACCEPT)
    async with AsyncNode(f"{name}_client") as node, AsyncNode(f"{name}_server") as server_node:
        server = server_node.create_action_server(Fibonacci, name, execute, **options)
        client = node.create_action_client(Fibonacci, name, feedback_sub_qos_profile=QoSProfile(depth=depth))
        await client.wait_for_server()
        yield _Pair(node, client, server_node, server)


def _result(*numbers: int) -> Any:
    return Fibonacci.Result(sequence=list(numbers))


async def _count(goal: Any) -> Any:
    """Send `order` times feedback, and succeed."""
    for number in range(goal.request.order):
        goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        await asyncio.sleep(0.002)
    goal.succeed()
    return _result(goal.request.order)


async def _forever(goal: Any) -> Any:
    await asyncio.sleep(999)


def _goal(order: int = 1) -> Any:
    return Fibonacci.Goal(order=order)


# A goal that succeeds


@pytest.mark.parametrize("plain", [True, False])
@on_loop
async def test_a_result(name: str, plain: bool) -> None:
    """A function or a coroutine function executes the goal; the response has status and result."""

    def at_once(goal: Any) -> Any:
        goal.succeed()
        return _result(goal.request.order)

    async with _pair(name, at_once if plain else _count) as pair:
        assert pair.client.server_is_ready()
        response = await pair.client.send_goal(_goal(3))
    assert response.status == GoalStatus.STATUS_SUCCEEDED
    assert list(response.result.sequence) == [3]


@on_loop
async def test_feedback_in_order(name: str) -> None:
    """All of it, and the iteration ends with the goal."""
    async with _pair(name, _count) as pair, pair.client.goal(_goal(5)) as goal:
        got = [each.sequence[0] async for each in goal.feedback()]
        response = await goal.result()
    assert got == [0, 1, 2, 3, 4]
    assert list(response.result.sequence) == [5]
    assert goal.status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_a_callback_for_feedback(name: str) -> None:
    """`send_goal` hands each message to a function or coroutine function."""
    got: list[int] = []

    async def keep(message: Any) -> None:
        await asyncio.sleep(0)
        got.append(message.feedback.sequence[0])

    async with _pair(name, _count) as pair:
        await pair.client.send_goal(_goal(3), feedback_callback=keep)
        await eventually(lambda: len(got) == 3)
        await pair.client.send_goal(
            _goal(2), feedback_callback=lambda message: got.append(10 + message.feedback.sequence[0])
        )
        await eventually(lambda: len(got) == 5)
    assert got == [0, 1, 2, 10, 11]


@on_loop
async def test_feedback_that_comes_with_the_result(name: str) -> None:
    """None of it is lost when the client has no time until the goal has ended."""

    async def execute(goal: Any) -> Any:
        for number in range(5):
            goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        goal.succeed()
        return _result()

    async with _pair(name, execute) as pair:
        for _ in range(5):
            async with pair.client.goal(_goal()) as goal:
                assert [each.sequence[0] async for each in goal.feedback()] == [0, 1, 2, 3, 4]


@on_loop
async def test_slow_readers_miss_the_oldest_feedback(name: str) -> None:
    """No more is kept than the depth of the QoS."""
    async with _pair(name, _count, depth=3) as pair, pair.client.goal(_goal(8)) as goal:
        await goal.result()
        await turns()
        got = [each.sequence[0] async for each in goal.feedback()]
    assert got == [5, 6, 7]


@on_loop
async def test_what_a_goal_says(name: str) -> None:
    """Its id, which may be chosen, its stamp and its status."""
    uuid = UUID(uuid=list(range(16)))
    async with _pair(name, _count) as pair, pair.client.goal(_goal(3), goal_uuid=uuid) as goal:
        assert goal.accepted
        assert bytes(goal.goal_id.uuid) == bytes(range(16))
        assert goal.stamp.sec > 0
        await goal.result()
        assert goal.status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_many_await_a_result(name: str) -> None:
    """Each gets it, also later; one who gives up takes it from nobody."""
    async with _pair(name, _count) as pair, pair.client.goal(_goal(5)) as goal:
        given_up = asyncio.create_task(goal.result())
        await turns(1)
        given_up.cancel()
        responses = [*await asyncio.gather(goal.result(), goal.result()), await goal.result()]
    assert [list(each.result.sequence) for each in responses] == [[5]] * 3
    assert given_up.cancelled()


@on_loop
async def test_a_result_that_waits_longer_than_it_is_kept(name: str) -> None:
    """It is asked for when the goal is accepted, so that the server cannot forget it."""
    async with _pair(name, _count, result_timeout=0) as pair, pair.client.goal(_goal(20)) as goal:
        assert len([each async for each in goal.feedback()]) == 20
        await turns()
        response = await goal.result()
    assert response.status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_asyncio_timeout_that_is_long_enough(name: str) -> None:
    """A deadline that does not pass changes nothing."""
    async with _pair(name, _count) as pair, asyncio.timeout(20):
        assert (await pair.client.send_goal(_goal(1))).status == GoalStatus.STATUS_SUCCEEDED


# A goal that is not accepted


@pytest.mark.parametrize("plain", [True, False])
@on_loop
async def test_a_rejected_goal(name: str, plain: bool) -> None:
    """An error, and neither `async with` begins nor the callback runs."""

    async def decide_later(goal: Any) -> Any:
        await asyncio.sleep(0.001)
        return GoalResponse.REJECT

    decide = (lambda goal: GoalResponse.REJECT) if plain else decide_later
    async with _pair(name, _forever, goal_callback=decide) as pair:
        with pytest.raises(GoalRejectedError, match=name):
            await pair.client.send_goal(_goal())
        with pytest.raises(GoalRejectedError):
            async with pair.client.goal(_goal()):
                pytest.fail("it was not accepted")


@on_loop
async def test_a_goal_of_another_class(name: str) -> None:
    """A TypeError, and the client stays usable."""
    async with _pair(name, _count) as pair:
        with pytest.raises(TypeError):
            await pair.client.send_goal(Fibonacci.Result())
        assert (await pair.client.send_goal(_goal(0))).status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_no_server(name: str) -> None:
    """`asyncio.timeout` ends both waits at once."""
    async with AsyncNode(name) as node:
        client = node.create_action_client(Fibonacci, name)
        for wait in (client.wait_for_server(), client.send_goal(_goal())):
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(0.05):
                    await wait


@on_loop
async def test_a_client_that_cannot(name: str) -> None:
    """On a node that does not run, and once it is destroyed."""
    node = AsyncNode(name)
    client = node.create_action_client(Fibonacci, name)
    with pytest.raises(RuntimeError, match="does not run"):
        await client.send_goal(_goal())
    with pytest.raises(RuntimeError, match="does not run"):
        await client.wait_for_server()
    client.destroy()
    client.destroy()
    with pytest.raises(RuntimeError, match="destroyed"):
        await client.send_goal(_goal())
    node.destroy_node()
    with pytest.raises(RuntimeError, match="Cannot create action client on a destroyed node"):
        node.create_action_client(Fibonacci, name)
    with pytest.raises(RuntimeError, match="Cannot create action server on a destroyed node"):
        node.create_action_server(Fibonacci, name, _count)


# Cancelling


def _watched(ends: list[str], began: asyncio.Event) -> Execute:
    async def execute(goal: Any) -> Any:
        began.set()
        try:
            await asyncio.sleep(999)
        except asyncio.CancelledError:
            ends.append(str(goal.is_cancel_requested))
            raise

    return execute


@on_loop
async def test_cancelling_the_task_cancels_the_goal(name: str) -> None:
    """The task of the server is cancelled, and the CancelledError of the client goes on."""
    ends: list[str] = []
    began = asyncio.Event()
    async with _pair(name, _watched(ends, began)) as pair:
        sending = asyncio.create_task(pair.client.send_goal(_goal()))
        await began.wait()
        sending.cancel()
        with pytest.raises(asyncio.CancelledError):
            await sending
        await eventually(lambda: ends)
    assert ends == ["True"]


@on_loop
async def test_a_deadline_cancels_the_goal(name: str) -> None:
    """`asyncio.timeout` is a TimeoutError here, and a cancelled goal there."""
    ends: list[str] = []
    async with _pair(name, _watched(ends, asyncio.Event())) as pair:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1):
                await pair.client.send_goal(_goal())
        await eventually(lambda: ends)
    assert ends == ["True"]


@on_loop
async def test_cancelling_before_the_answer(name: str) -> None:
    """The goal is cancelled as soon as it is accepted: none goes on that nobody wants."""
    ends: list[str] = []
    began, asked, free = asyncio.Event(), asyncio.Event(), asyncio.Event()

    async def decide(goal: Any) -> Any:
        asked.set()
        await free.wait()
        return GoalResponse.ACCEPT

    async with _pair(name, _watched(ends, began), goal_callback=decide) as pair:
        sending = asyncio.create_task(pair.client.send_goal(_goal()))
        await asked.wait()
        sending.cancel()
        await turns(2)
        assert not sending.done()
        free.set()
        with pytest.raises(asyncio.CancelledError):
            await sending
        await eventually(lambda: ends == ["True"] or not began.is_set())
        await turns()
    assert ends in ([], ["True"])


@on_loop
async def test_leaving_a_goal_early(name: str) -> None:
    """It is cancelled, and has ended when the block is left."""
    ends: list[str] = []
    began = asyncio.Event()
    async with _pair(name, _watched(ends, began)) as pair:
        async with pair.client.goal(_goal()) as goal:
            await began.wait()
        assert ends == ["True"]
        assert goal.status == GoalStatus.STATUS_CANCELED
        with pytest.raises(ValueError, match="of the body"):
            async with pair.client.goal(_goal()):
                raise ValueError("of the body")
    assert goal.status == GoalStatus.STATUS_CANCELED


@on_loop
async def test_breaking_out_of_the_feedback(name: str) -> None:
    """The same for who has seen enough."""
    async with _pair(name, _count) as pair:
        async with pair.client.goal(_goal(1000)) as goal:
            async for _ in goal.feedback():
                break
        assert goal.status == GoalStatus.STATUS_CANCELED
        assert [each async for each in goal.feedback()][5:] == []


@on_loop
async def test_cancel(name: str) -> None:
    """The response names the goal; the result is that of a cancelled one."""
    async with _pair(name, _forever) as pair, pair.client.goal(_goal()) as goal:
        response = await goal.cancel()
        assert [bytes(each.goal_id.uuid) for each in response.goals_canceling] == [bytes(goal.goal_id.uuid)]
        assert (await goal.result()).status == GoalStatus.STATUS_CANCELED


@on_loop
async def test_a_refused_cancel(name: str) -> None:
    """The goal goes on, and so does who waits for it."""
    async with _pair(name, _count, accepts_cancel=False) as pair, pair.client.goal(_goal(20)) as goal:
        assert not (await goal.cancel()).goals_canceling
        assert (await goal.result()).status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_a_refused_cancel_of_a_task(name: str) -> None:
    """Nobody has to wait for the goal's end: neither a deadline nor the end of the block."""
    free = asyncio.Event()

    async def execute(goal: Any) -> Any:
        await free.wait()
        goal.succeed()

    async with _pair(name, execute, accepts_cancel=False) as pair:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1):
                await pair.client.send_goal(_goal())
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1), pair.client.goal(_goal()):
                pass
            async with asyncio.timeout(0.1):
                await pair.client.send_goal(_goal())
        free.set()


@pytest.mark.parametrize("succeeds", [True, False])
@on_loop
async def test_catching_the_cancellation(name: str, succeeds: bool) -> None:
    """A callback may give a result, and may even succeed."""

    async def execute(goal: Any) -> Any:
        try:
            await asyncio.sleep(999)
        except asyncio.CancelledError:
            await asyncio.sleep(0)
            if succeeds:
                goal.succeed()
            return _result(7)

    async with _pair(name, execute) as pair, pair.client.goal(_goal()) as goal:
        await turns(2)
        await goal.cancel()
        response = await goal.result()
    assert response.status == (GoalStatus.STATUS_SUCCEEDED if succeeds else GoalStatus.STATUS_CANCELED)
    assert list(response.result.sequence) == [7]


@on_loop
async def test_a_callback_that_decides_later(name: str) -> None:
    """A coroutine decides about the cancellation; other requests are served meanwhile."""
    asked, free = asyncio.Event(), asyncio.Event()

    async def decide(goal: Any) -> Any:
        asked.set()
        await free.wait()
        return CancelResponse.ACCEPT

    async def execute(goal: Any) -> Any:
        return await (_forever if goal.request.order == 1 else _count)(goal)

    paired = _pair(name, execute, cancel_callback=decide, concurrent=True)
    async with paired as pair, pair.client.goal(_goal(1)) as goal:
        cancelling = asyncio.create_task(goal.cancel())
        await asked.wait()
        assert (await pair.client.send_goal(_goal(2))).status == GoalStatus.STATUS_SUCCEEDED
        free.set()
        assert (await cancelling).goals_canceling
        assert (await goal.result()).status == GoalStatus.STATUS_CANCELED


@on_loop
async def test_cancelling_one_of_two(name: str) -> None:
    """The other one goes on."""

    async def execute(goal: Any) -> Any:
        return await (_forever if goal.request.order == 1 else _count)(goal)

    async with _pair(name, execute, concurrent=2) as pair:
        other = asyncio.create_task(pair.client.send_goal(_goal(20)))
        async with pair.client.goal(_goal(1)) as goal:
            pass
        assert goal.status == GoalStatus.STATUS_CANCELED
        assert (await other).status == GoalStatus.STATUS_SUCCEEDED


@on_loop
async def test_cancelling_a_goal_that_waits_for_its_turn(name: str) -> None:
    """It ends as cancelled without having run."""
    ran: list[int] = []
    free = asyncio.Event()

    async def execute(goal: Any) -> Any:
        ran.append(goal.request.order)
        await free.wait()
        goal.succeed()
        return _result()

    async with _pair(name, execute) as pair:
        first = asyncio.create_task(pair.client.send_goal(_goal(1)))
        await eventually(lambda: ran)
        async with pair.client.goal(_goal(2)) as second:
            await second.cancel()
            assert (await second.result()).status == GoalStatus.STATUS_CANCELED
        free.set()
        assert (await first).status == GoalStatus.STATUS_SUCCEEDED
    assert ran == [1]


# Several goals


@pytest.mark.parametrize(("concurrent", "most_expected"), [(False, 1), (2, 2), (True, 4)])
@on_loop
async def test_goals_at_the_same_time(name: str, concurrent: bool | int, most_expected: int) -> None:
    """One after the other, two at a time, or all of them."""
    now = most = 0

    async def execute(goal: Any) -> Any:
        nonlocal now, most
        now += 1
        most = max(most, now)
        await asyncio.sleep(0.03)
        now -= 1
        goal.succeed()
        return _result(goal.request.order)

    async with _pair(name, execute, concurrent=concurrent) as pair:
        responses = await asyncio.gather(*(pair.client.send_goal(_goal(number)) for number in range(4)))
    assert [list(each.result.sequence) for each in responses] == [[0], [1], [2], [3]]
    assert most == most_expected


@on_loop
async def test_feedback_of_two_goals(name: str) -> None:
    """Each gets its own."""

    async def execute(goal: Any) -> Any:
        for _ in range(3):
            goal.publish_feedback(Fibonacci.Feedback(sequence=[goal.request.order]))
            await asyncio.sleep(0.002)
        goal.succeed()
        return _result()

    async def read(order: int) -> list[int]:
        async with pair.client.goal(_goal(order)) as goal:
            return [each.sequence[0] async for each in goal.feedback()]

    async with _pair(name, execute, concurrent=True) as pair:
        assert await asyncio.gather(read(1), read(2)) == [[1] * 3, [2] * 3]


# Ends of another kind


@on_loop
async def test_aborting(name: str) -> None:
    """A status, not an exception."""

    async def execute(goal: Any) -> Any:
        goal.abort()
        return _result(4)

    async with _pair(name, execute) as pair:
        response = await pair.client.send_goal(_goal())
    assert response.status == GoalStatus.STATUS_ABORTED
    assert list(response.result.sequence) == [4]


@on_loop
async def test_a_callback_that_ends_nothing(name: str) -> None:
    """The goal counts as aborted, as with ActionServer."""

    async def execute(goal: Any) -> Any:
        return _result(1)

    async with _pair(name, execute) as pair:
        assert (await pair.client.send_goal(_goal())).status == GoalStatus.STATUS_ABORTED


@on_loop
async def test_an_exception(name: str) -> None:
    """The client hears that the goal is aborted; then the server's node ends in an ExceptionGroup."""

    async def fail(goal: Any) -> Any:
        await asyncio.sleep(0.01)
        raise ValueError("of the goal")

    async with AsyncNode(f"{name}_client") as node:
        server_node = AsyncNode(f"{name}_server")
        server_node.create_action_server(Fibonacci, name, fail)
        running = asyncio.create_task(server_node.run())
        client = node.create_action_client(Fibonacci, name)
        await client.wait_for_server()
        response = await client.send_goal(_goal())
        assert response.status == GoalStatus.STATUS_ABORTED
        with pytest.raises(ExceptionGroup) as caught:
            await running
    assert caught.group_contains(ValueError, match="of the goal")


@pytest.mark.parametrize("what", ["node", "server"])
@on_loop
async def test_the_server_leaves(name: str, what: str) -> None:
    """Goals that execute and goals that wait are aborted, and their clients hear of it before that."""
    cancelled: list[int] = []

    async def execute(goal: Any) -> Any:
        try:
            await asyncio.sleep(999)
        except asyncio.CancelledError:
            cancelled.append(goal.request.order)
            raise

    async with _pair(name, execute) as pair:
        async with pair.client.goal(_goal(1)) as first, pair.client.goal(_goal(2)) as second:
            await turns()
            (pair.server_node.destroy_node if what == "node" else pair.server.destroy)()
            assert (await first.result()).status == GoalStatus.STATUS_ABORTED
            assert (await second.result()).status == GoalStatus.STATUS_ABORTED
        pair.server.destroy()
    assert cancelled == [1]


@on_loop
async def test_the_client_leaves(name: str) -> None:
    """Who awaits a goal gets a CancelledError, and its feedback ends."""
    async with _pair(name, _forever) as pair:
        goal = pair.client.goal(_goal())
        await goal.open()
        waits = asyncio.create_task(goal.result())
        await turns(2)
        pair.client.destroy()
        assert [each async for each in goal.feedback()] == []
        with pytest.raises(asyncio.CancelledError):
            await waits


@on_loop
async def test_shutting_down_a_node_that_waits_for_a_goal(name: str) -> None:
    """Destroying the client's node ends `send_goal`."""
    async with _pair(name, _forever) as pair:
        sending = asyncio.create_task(pair.client.send_goal(_goal()))
        await turns()
        pair.node.destroy_node()
        with pytest.raises((asyncio.CancelledError, ServerGoneError)):
            await sending
