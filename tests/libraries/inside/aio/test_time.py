"""Clocks and timers of an AsyncNode, on wall time and on simulated time."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from rclpy.clock_type import ClockType
from rclpy.parameter import Parameter
from rclpy.time import Time
from rclpy_asyncio import AsyncClock, AsyncNode, TimeSourceChangedError
from rosgraph_msgs.msg import Clock

from tests.libraries.inside.aio.conftest import eventually, on_loop, turns


def _simulated(name: str) -> AsyncNode:
    return AsyncNode(name, parameter_overrides=[Parameter("use_sim_time", Parameter.Type.BOOL, True)])


def _at(seconds: float) -> Time:
    return Time(nanoseconds=int(seconds * 1e9), clock_type=ClockType.ROS_TIME)


# Clocks


@on_loop
async def test_a_sleep_on_wall_time(name: str) -> None:
    """It lasts as long as it should."""
    async with AsyncNode(name) as node:
        before = node.get_clock().now()
        await node.get_clock().sleep(0.02)
        assert (node.get_clock().now() - before).nanoseconds >= 19_000_000


@pytest.mark.parametrize("duration", [0, -1])
@on_loop
async def test_no_sleep(name: str, duration: float) -> None:
    """Zero and less is one turn of the loop, also in simulated time."""
    async with _simulated(name) as node:
        await node.get_clock().sleep(duration)


@on_loop
async def test_destroying_the_node_cancels_sleeps(name: str) -> None:
    """The sleeper gets a CancelledError."""
    async with AsyncNode(name) as node:
        sleeping = asyncio.create_task(node.get_clock().sleep(999))
        await turns(2)
        node.destroy_node()
        with pytest.raises(asyncio.CancelledError):
            await sleeping


@pytest.mark.parametrize("before", [False, True])
@on_loop
async def test_a_change_of_the_source_during_a_sleep(name: str, before: bool) -> None:
    """`use_sim_time` is switched on or off: the sleep cannot know what it waits for any more."""
    async with _simulated(name) if before else AsyncNode(name) as node:
        sleeping = asyncio.create_task(node.get_clock().sleep(999))
        await turns(2)
        node.set_parameters([Parameter("use_sim_time", Parameter.Type.BOOL, not before)])
        with pytest.raises(TimeSourceChangedError):
            await sleeping


@on_loop
async def test_a_sleep_on_a_destroyed_clock(name: str) -> None:
    """It is refused."""
    clock = AsyncClock()
    clock.destroy()
    with pytest.raises(RuntimeError, match="Cannot sleep on a destroyed clock"):
        await clock.sleep(1)


@on_loop
async def test_a_jump_ends_sleeps(name: str) -> None:
    """Only those whose time has come; a jump back moves no end."""
    async with _simulated(name) as node:
        clock = node.get_clock()
        clock.set_ros_time_override(_at(10))
        short, long = (asyncio.create_task(clock.sleep(seconds)) for seconds in (1, 5))
        await turns(2)
        clock.set_ros_time_override(_at(10.5))
        clock.set_ros_time_override(_at(9))
        await turns(2)
        assert not short.done()
        clock.set_ros_time_override(_at(11))
        await short
        assert not long.done()
        clock.set_ros_time_override(_at(20))
        await long


@on_loop
async def test_clock_messages_end_sleeps(name: str) -> None:
    """The same over the topic /clock, which is subscribed only in simulated time."""
    async with AsyncNode(f"{name}_pub") as teller, AsyncNode(name) as node:
        publisher = teller.create_publisher(Clock, "/clock", 1)
        assert publisher.get_subscription_count() == 0
        node.set_parameters([Parameter("use_sim_time", Parameter.Type.BOOL, True)])
        await eventually(publisher.get_subscription_count)
        clock = node.get_clock()

        async def tell(seconds: int) -> None:
            message = Clock()
            message.clock.sec = seconds
            while clock.now().nanoseconds != seconds * 10**9:
                publisher.publish(message)
                await turns(2)

        await tell(5)
        sleeping = asyncio.create_task(clock.sleep(10))
        await turns(2)
        await tell(14)
        assert not sleeping.done()
        await tell(15)
        await sleeping


@on_loop
async def test_sleeps_side_by_side(name: str) -> None:
    """Three sleeps end in the order of their lengths, none of them early."""
    ended: list[float] = []
    async with AsyncNode(name) as node:
        clock = node.get_clock()
        start = clock.now()

        async def sleep(seconds: float) -> None:
            await clock.sleep(seconds)
            assert (clock.now() - start).nanoseconds >= seconds * 0.95e9
            ended.append(seconds)

        await asyncio.gather(sleep(0.06), sleep(0.02), sleep(0.04))
    assert ended == [0.02, 0.04, 0.06]


# Timers


@pytest.mark.parametrize("times", [1, 3])
@pytest.mark.parametrize("plain", [True, False])
@on_loop
async def test_calls(name: str, times: int, plain: bool) -> None:
    """A function or a coroutine function is called again and again."""
    calls = 0

    def count() -> None:
        nonlocal calls
        calls += 1

    async def count_later() -> None:
        await asyncio.sleep(0)
        count()

    async with AsyncNode(name) as node:
        node.create_timer(0.005, count if plain else count_later)
        await eventually(lambda: calls >= times)


@on_loop
async def test_a_period_of_zero(name: str) -> None:
    """It is called each turn, and the loop goes on."""
    calls = 0

    def count() -> None:
        nonlocal calls
        calls += 1

    async with AsyncNode(name) as node:
        node.create_timer(0.0, count)
        await eventually(lambda: calls >= 3)


def test_a_timer_made_before_entering(name: str) -> None:
    """It is called once the node runs."""
    node = AsyncNode(name)
    calls: list[None] = []
    node.create_timer(0.001, lambda: calls.append(None))

    @on_loop
    async def run() -> None:
        async with node:
            await eventually(lambda: calls)

    run()


@on_loop
async def test_cancel_and_reset(name: str) -> None:
    """It is silent while it is cancelled, and both count during its wait."""
    calls: list[None] = []
    async with AsyncNode(name) as node:
        timer = node.create_timer(0.005, lambda: calls.append(None))
        await eventually(lambda: calls)
        timer.cancel()
        count = len(calls)
        await turns()
        assert len(calls) == count
        timer.reset()
        await eventually(lambda: len(calls) > count)


@on_loop
async def test_a_callback_that_cancels_its_timer(name: str) -> None:
    """There is no second call."""
    calls: list[None] = []
    async with AsyncNode(name) as node:

        def once() -> None:
            calls.append(None)
            timer.cancel()

        timer = node.create_timer(0.001, once)
        await eventually(lambda: calls)
        await turns()
    assert len(calls) == 1


@on_loop
async def test_destroy(name: str) -> None:
    """It is silent afterwards."""
    calls: list[None] = []
    async with AsyncNode(name) as node:
        timer = node.create_timer(0.005, lambda: calls.append(None))
        await eventually(lambda: calls)
        timer.destroy()
        count = len(calls)
        await turns()
    assert len(calls) == count


@on_loop
async def test_an_exception_of_a_timer(name: str) -> None:
    """It ends the node in an ExceptionGroup."""

    def fail() -> None:
        raise ValueError("of the timer")

    node = AsyncNode(name)
    node.create_timer(0.001, fail)
    with pytest.raises(ExceptionGroup) as caught:
        await node.run()
    assert caught.group_contains(ValueError, match="of the timer")


@on_loop
async def test_the_times_of_a_call(name: str) -> None:
    """A callback with one argument gets when it was due, and when it was called."""
    got: list[Any] = []
    async with AsyncNode(name) as node:
        node.create_timer(0.005, got.append)
        await eventually(lambda: len(got) >= 2)
    for info in got:
        assert 0 < info.expected_call_time.nanoseconds <= info.actual_call_time.nanoseconds


@on_loop
async def test_a_callback_with_two_arguments(name: str) -> None:
    """It is refused when the timer is made."""
    node = AsyncNode(name)
    with pytest.raises(RuntimeError, match="Timer callback must accept zero arguments or one"):
        node.create_timer(1.0, lambda a, b: None)
    node.destroy_node()


@on_loop
async def test_what_a_timer_says(name: str) -> None:
    """Its period, its state and its times."""
    async with AsyncNode(name) as node:
        timer = node.create_timer(100.0, lambda: None)
        assert timer.timer_period_ns == 100 * 10**9
        assert timer.clock is node.get_clock()
        assert not timer.is_ready()
        assert not timer.is_canceled()
        assert 0 < (timer.time_until_next_call() or 0) <= 100 * 10**9
        assert timer.time_since_last_call() >= 0
        timer.cancel()
        assert timer.is_canceled()
        timer.reset()
        assert not timer.is_canceled()
        stopped = node.create_timer(1.0, lambda: None, autostart=False)
        assert stopped.is_canceled()


@on_loop
async def test_a_timer_in_simulated_time(name: str) -> None:
    """One call when the time passes the period, none before."""
    calls: list[None] = []
    async with _simulated(name) as node:
        clock = node.get_clock()
        clock.set_ros_time_override(_at(100))
        node.create_timer(1.0, lambda: calls.append(None))
        await turns(3)
        clock.set_ros_time_override(_at(100.5))
        await turns(3)
        assert not calls
        clock.set_ros_time_override(_at(101))
        await eventually(lambda: calls)
        await turns(3)
    assert len(calls) == 1


def test_virtual_time(ros_virtual_clock: Any, name: str) -> None:
    """The loop waits as everything else does there: a minute and a half take no time."""
    calls: list[None] = []

    async def run() -> None:
        async with AsyncNode(name) as node:
            node.create_timer(10.0, lambda: calls.append(None))
            await node.get_clock().sleep(95)

    asyncio.run(run())
    assert len(calls) == 9
