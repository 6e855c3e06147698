"""Topics, services and their clients of an AsyncNode."""

from __future__ import annotations

import asyncio
from typing import Any

import anyio
import pytest
from example_interfaces.srv import AddTwoInts
from ifgen_runtime.errors import ServerGoneError
from rclpy.exceptions import InvalidHandle
from rclpy_asyncio import AsyncNode
from std_msgs.msg import Int32, String

from tests.libraries.inside.aio.conftest import eventually, met, on_loop, turns


def _add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


# Publishers and subscriptions


@on_loop
async def test_a_message(name: str) -> None:
    """A plain function gets it."""
    got: list[Any] = []
    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        subscription = node.create_subscription(String, name, got.append, 10)
        await met(publisher, subscription)
        publisher.publish(String(data="hello"))
        await eventually(lambda: got)
    assert got == [String(data="hello")]


@on_loop
async def test_metadata(name: str) -> None:
    """A callback with two arguments gets the metadata, too."""
    got: list[tuple[Any, Any]] = []
    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        subscription = node.create_subscription(
            String, name, lambda message, info: got.append((message, info)), 10
        )
        await met(publisher, subscription)
        publisher.publish(String(data="hello"))
        await eventually(lambda: got)
    message, info = got[0]
    assert message.data == "hello"
    assert 0 < info["source_timestamp"] <= info["received_timestamp"]


@pytest.mark.parametrize("concurrent", [False, True])
@pytest.mark.parametrize("plain", [False, True])
@on_loop
async def test_an_exception_of_a_subscription(name: str, concurrent: bool, plain: bool) -> None:
    """It ends the node, and comes out of `run` in an ExceptionGroup."""

    def fail(message: Any) -> None:
        raise ValueError(message.data)

    async def fail_later(message: Any) -> None:
        await asyncio.sleep(0)
        raise ValueError(message.data)

    node = AsyncNode(name)
    publisher = node.create_publisher(String, name, 10)
    subscription = node.create_subscription(
        String, name, fail if plain else fail_later, 10, concurrent=concurrent
    )

    async def publish() -> None:
        await met(publisher, subscription)
        publisher.publish(String(data="wrong"))

    publishing = asyncio.create_task(publish())
    with pytest.raises(ExceptionGroup) as caught:
        await node.run()
    await publishing
    assert caught.group_contains(ValueError, match="wrong")


@on_loop
async def test_concurrent_messages(name: str) -> None:
    """Three callbacks meet at one barrier."""
    barrier, met_there = asyncio.Barrier(3), []

    async def meet(message: Any) -> None:
        await barrier.wait()
        met_there.append(message.data)

    async with AsyncNode(name) as node:
        publisher = node.create_publisher(Int32, name, 10)
        subscription = node.create_subscription(Int32, name, meet, 10, concurrent=True)
        await met(publisher, subscription)
        for number in range(3):
            publisher.publish(Int32(data=number))
        await eventually(lambda: len(met_there) == 3)
    assert sorted(met_there) == [0, 1, 2]


@on_loop
async def test_a_bound_for_concurrent_messages(name: str) -> None:
    """No more than two at a time, and the others wait in the history."""
    now = most = done = 0

    async def count(message: Any) -> None:
        nonlocal now, most, done
        now += 1
        most = max(most, now)
        await turns(3)
        now -= 1
        done += 1

    async with AsyncNode(name) as node:
        publisher = node.create_publisher(Int32, name, 10)
        subscription = node.create_subscription(Int32, name, count, 10, concurrent=2)
        await met(publisher, subscription)
        for number in range(10):
            publisher.publish(Int32(data=number))
        await eventually(lambda: done == 10)
    assert most == 2


@on_loop
async def test_a_slow_callback_loses_the_oldest(name: str) -> None:
    """One after the other: the history keeps the last two while the callback is busy."""
    got: list[int] = []
    free = asyncio.Event()

    async def be_slow(message: Any) -> None:
        got.append(message.data)
        await free.wait()

    async with AsyncNode(name) as node:
        publisher = node.create_publisher(Int32, name, 10)
        subscription = node.create_subscription(Int32, name, be_slow, 2)
        await met(publisher, subscription)
        publisher.publish(Int32(data=0))
        await eventually(lambda: got)
        for number in range(1, 6):
            publisher.publish(Int32(data=number))
        await turns()
        free.set()
        await eventually(lambda: len(got) == 3)
        await turns()
    assert got == [0, 4, 5]


@on_loop
async def test_asyncio_and_anyio_in_callbacks(name: str) -> None:
    """`sleep`, `gather`, task groups and anyio."""
    done: list[str] = []

    async def work(message: Any) -> None:
        async def step(text: str) -> None:
            await asyncio.sleep(0.001)
            done.append(text)

        await asyncio.gather(step("gather"), step("gather"))
        async with asyncio.TaskGroup() as group:
            group.create_task(step("group"))
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(step, "anyio")
        with anyio.move_on_after(0.001):
            await anyio.sleep(99)
        done.append("end")

    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        subscription = node.create_subscription(String, name, work, 10)
        await met(publisher, subscription)
        publisher.publish(String())
        await eventually(lambda: "end" in done)
    assert done == ["gather", "gather", "group", "anyio", "end"]


@pytest.mark.parametrize("plain", [True, False])
@on_loop
async def test_callbacks_that_never_wait(name: str, plain: bool) -> None:
    """Each publishes the next message; the loop gets its turn all the same."""
    ended = False

    def chain(message: Any) -> None:
        if not ended:
            publisher.publish(message)

    async def chain_later(message: Any) -> None:
        chain(message)

    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        subscription = node.create_subscription(String, name, chain if plain else chain_later, 10)
        await met(publisher, subscription)
        publisher.publish(String())
        await turns()
        ended = True


@on_loop
async def test_a_destroyed_publisher(name: str) -> None:
    """`publish` raises InvalidHandle, which is a RuntimeError."""
    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        publisher.destroy()
        with pytest.raises(InvalidHandle):
            publisher.publish(String())
        with pytest.raises(RuntimeError):
            publisher.publish(String())


@on_loop
async def test_a_callback_that_uses_what_is_destroyed(name: str) -> None:
    """Its InvalidHandle ends the node as any other exception does."""
    node = AsyncNode(name)
    gone = node.create_publisher(String, name, 1)
    gone.destroy()
    publisher = node.create_publisher(String, name, 1)
    subscription = node.create_subscription(String, name, gone.publish, 1)

    async def publish() -> None:
        await met(publisher, subscription)
        publisher.publish(String())

    publishing = asyncio.create_task(publish())
    with pytest.raises(ExceptionGroup) as caught:
        await node.run()
    await publishing
    assert caught.group_contains(InvalidHandle)


@on_loop
async def test_publishing_without_running(name: str) -> None:
    """A node that was never entered publishes."""
    got: list[Any] = []
    silent = AsyncNode(f"{name}_silent")
    publisher = silent.create_publisher(String, name, 10)
    async with AsyncNode(name) as node:
        subscription = node.create_subscription(String, name, got.append, 10)
        await met(publisher, subscription)
        publisher.publish(String(data="hello"))
        await eventually(lambda: got)
    silent.destroy_node()


# Services and clients


@pytest.mark.parametrize("plain", [True, False])
@on_loop
async def test_a_call(name: str, plain: bool) -> None:
    """A function or a coroutine function of another node responds."""

    async def add_later(request: Any, response: Any) -> Any:
        await asyncio.sleep(0.001)
        return _add(request, response)

    async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
        a.create_service(AddTwoInts, name, _add if plain else add_later)
        client = b.create_client(AddTwoInts, name)
        await client.wait_for_service()
        assert client.service_is_ready()
        assert (await client.call(AddTwoInts.Request(a=2, b=3))).sum == 5


@on_loop
async def test_waiting_for_a_service_in_vain(name: str) -> None:
    """`asyncio.timeout` ends the wait."""
    async with AsyncNode(name) as node:
        client = node.create_client(AddTwoInts, name)
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.05):
                await client.wait_for_service()


@on_loop
async def test_calling_with_a_destroyed_client(name: str) -> None:
    """It is refused."""
    async with AsyncNode(name) as node:
        client = node.create_client(AddTwoInts, name)
        client.destroy()
        with pytest.raises(RuntimeError, match="Calling a destroyed client is forbidden"):
            await client.call(AddTwoInts.Request())


@on_loop
async def test_concurrent_calls(name: str) -> None:
    """Three calls of one client meet in a concurrent service."""
    barrier = asyncio.Barrier(3)

    async def meet(request: Any, response: Any) -> Any:
        await barrier.wait()
        return _add(request, response)

    async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
        a.create_service(AddTwoInts, name, meet, concurrent=True)
        client = b.create_client(AddTwoInts, name)
        await client.wait_for_service()
        calls = [client.call(AddTwoInts.Request(a=number, b=1)) for number in range(3)]
        assert [each.sum for each in await asyncio.gather(*calls)] == [1, 2, 3]


@on_loop
async def test_concurrent_callbacks_of_a_service(name: str) -> None:
    """Three requests of three clients run at the same time."""
    most = now = 0

    async def count(request: Any, response: Any) -> Any:
        nonlocal most, now
        now += 1
        most = max(most, now)
        await eventually(lambda: most == 3)
        now -= 1
        return _add(request, response)

    async with AsyncNode(name) as node:
        node.create_service(AddTwoInts, name, count, concurrent=True)
        clients = [node.create_client(AddTwoInts, name) for _ in range(3)]
        for client in clients:
            await client.wait_for_service()
        responses = await asyncio.gather(*(each.call(AddTwoInts.Request(a=1, b=1)) for each in clients))
    assert [each.sum for each in responses] == [2, 2, 2]


@on_loop
async def test_a_call_after_one_that_was_given_up(name: str) -> None:
    """The late response is dropped, and the client stays usable."""
    free = asyncio.Event()

    async def be_slow(request: Any, response: Any) -> Any:
        if request.a == 0:
            await free.wait()
        return _add(request, response)

    async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
        a.create_service(AddTwoInts, name, be_slow)
        client = b.create_client(AddTwoInts, name)
        await client.wait_for_service()
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.05):
                await client.call(AddTwoInts.Request(a=0, b=1))
        free.set()
        assert (await client.call(AddTwoInts.Request(a=2, b=1))).sum == 3


@on_loop
async def test_a_response_in_the_turn_of_the_cancellation(name: str) -> None:
    """Neither is lost: the caller is cancelled, and the node goes on."""
    async with AsyncNode(name) as node:
        calls: list[asyncio.Task[Any]] = []

        def respond(request: Any, response: Any) -> Any:
            asyncio.get_running_loop().call_soon(calls[-1].cancel)
            return _add(request, response)

        node.create_service(AddTwoInts, name, respond)
        client = node.create_client(AddTwoInts, name)
        await client.wait_for_service()
        for _ in range(20):
            calls.append(asyncio.create_task(client.call(AddTwoInts.Request(a=1, b=1))))
            (result,) = await asyncio.gather(calls[-1], return_exceptions=True)
            assert isinstance(result, asyncio.CancelledError) or result.sum == 2


@on_loop
async def test_destroying_a_client_during_a_call(name: str) -> None:
    """The caller gets a CancelledError."""
    async with AsyncNode(name) as node:
        node.create_service(AddTwoInts, name, lambda request, response: asyncio.sleep(99))
        client = node.create_client(AddTwoInts, name)
        await client.wait_for_service()
        call = asyncio.create_task(client.call(AddTwoInts.Request()))
        await turns(3)
        client.destroy()
        with pytest.raises(asyncio.CancelledError):
            await call


@pytest.mark.parametrize("concurrent", [False, True])
@on_loop
async def test_an_exception_of_a_service(name: str, concurrent: bool) -> None:
    """It ends the node of the service in an ExceptionGroup."""

    async def fail(request: Any, response: Any) -> Any:
        raise ValueError("of the service")

    async with AsyncNode(f"{name}_b") as b:
        node = AsyncNode(f"{name}_a")
        node.create_service(AddTwoInts, name, fail, concurrent=concurrent)
        running = asyncio.create_task(node.run())
        client = b.create_client(AddTwoInts, name)
        await client.wait_for_service()
        call = asyncio.create_task(client.call(AddTwoInts.Request()))
        with pytest.raises(ExceptionGroup) as caught:
            await running
        assert caught.group_contains(ValueError, match="of the service")
        call.cancel()
        # The local transport tells the client; real rclpy does not.
        with pytest.raises((asyncio.CancelledError, ServerGoneError)):
            await call


@pytest.mark.parametrize("concurrent", [False, True])
@on_loop
async def test_destroying_a_service_during_a_request(name: str, concurrent: bool) -> None:
    """The callback is cancelled, and there is no response."""
    began, cancelled = asyncio.Event(), asyncio.Event()

    async def wait(request: Any, response: Any) -> Any:
        began.set()
        try:
            await asyncio.sleep(99)
        except asyncio.CancelledError:
            cancelled.set()
            raise

    async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
        service = a.create_service(AddTwoInts, name, wait, concurrent=concurrent)
        client = b.create_client(AddTwoInts, name)
        await client.wait_for_service()
        call = asyncio.create_task(client.call(AddTwoInts.Request()))
        await began.wait()
        service.destroy()
        await cancelled.wait()
        # The local transport tells the client that there will be none; real rclpy lets it wait.
        with pytest.raises((TimeoutError, ServerGoneError)):
            async with asyncio.timeout(0.1):
                await call
