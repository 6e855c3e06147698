"""The life of an AsyncNode, and what it shares with Node."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent, ParameterType, ParameterValue
from rcl_interfaces.srv import GetLoggerLevels, GetParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_parameter_events
from rclpy_asyncio import AsyncNode
from std_msgs.msg import String
from type_description_interfaces.srv import GetTypeDescription

from tests.libraries.inside.aio.conftest import eventually, met, on_loop, turns


async def _nothing(*_: Any) -> None:
    pass


def _add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


@on_loop
async def test_enter_and_leave(name: str) -> None:
    """Entering gives the node itself; after leaving it is destroyed."""
    node = AsyncNode(name)
    async with node as entered:
        assert entered is node
        assert node.get_fully_qualified_name() == f"/{name}"
    with pytest.raises(RuntimeError, match="Node has been destroyed and cannot be reentered"):
        async with node:
            pass


@on_loop
async def test_a_destroyed_subscription_gets_nothing(name: str) -> None:
    """What is published after `destroy` does not arrive; other subscriptions go on."""
    first: list[str] = []
    second: list[str] = []
    async with AsyncNode(name) as node:
        publisher = node.create_publisher(String, name, 10)
        gone = node.create_subscription(String, name, lambda message: first.append(message.data), 10)
        stays = node.create_subscription(String, name, lambda message: second.append(message.data), 10)
        await met(publisher, gone)
        await met(publisher, stays)
        await eventually(lambda: publisher.get_subscription_count() == 2)
        publisher.publish(String(data="both"))
        await eventually(lambda: first and second)
        gone.destroy()
        publisher.publish(String(data="one"))
        await eventually(lambda: len(second) == 2)
    assert first == ["both"]


def test_entities_made_before_entering(name: str) -> None:
    """Entities that were made without any loop deliver once the node runs."""
    node = AsyncNode(name)
    got: list[str] = []
    publisher = node.create_publisher(String, name, 10)
    subscription = node.create_subscription(String, name, lambda message: got.append(message.data), 10)

    @on_loop
    async def run() -> None:
        async with node:
            await met(publisher, subscription)
            publisher.publish(String(data="early"))
            await eventually(lambda: got)

    run()
    assert got == ["early"]


@on_loop
async def test_two_nodes_talk_both_ways(name: str) -> None:
    """Two nodes on one loop."""
    got: list[str] = []
    async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
        ping = a.create_publisher(String, f"{name}/ping", 10)
        pong = b.create_publisher(String, f"{name}/pong", 10)
        to_b = b.create_subscription(String, f"{name}/ping", pong.publish, 10)
        to_a = a.create_subscription(String, f"{name}/pong", lambda message: got.append(message.data), 10)
        await met(ping, to_b)
        await met(pong, to_a)
        ping.publish(String(data="there and back"))
        await eventually(lambda: got)
    assert got == ["there and back"]


@on_loop
async def test_logger_service(name: str) -> None:
    """The services of loggers answer."""
    async with AsyncNode(name, enable_logger_service=True) as node, AsyncNode(f"{name}_asks") as asker:
        client = asker.create_client(GetLoggerLevels, f"/{name}/get_logger_levels")
        await client.wait_for_service()
        response = await client.call(GetLoggerLevels.Request(names=[node.get_logger().name]))
    assert [level.name for level in response.levels] == [name]


@on_loop
async def test_parameter_services(name: str) -> None:
    """Get 42, set 99, get 99."""
    async with AsyncNode(name) as node, AsyncNode(f"{name}_asks") as asker:
        node.declare_parameter("answer", 42)
        get = asker.create_client(GetParameters, f"/{name}/get_parameters")
        put = asker.create_client(SetParameters, f"/{name}/set_parameters")
        await get.wait_for_service()
        await put.wait_for_service()
        asked = GetParameters.Request(names=["answer"])
        before = await get.call(asked)
        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=99)
        result = await put.call(SetParameters.Request(parameters=[ParameterMsg(name="answer", value=value)]))
        after = await get.call(asked)
    assert before.values[0].integer_value == 42
    assert result.results[0].successful
    assert after.values[0].integer_value == 99


@on_loop
async def test_run_ends_with_the_node(name: str) -> None:
    """`run` returns when something destroys the node."""
    node = AsyncNode(name)
    asyncio.get_running_loop().call_later(0.01, node.destroy_node)
    await node.run()


@on_loop
async def test_a_callback_ends_run(name: str) -> None:
    """`destroy_node` in a callback of the node is a clean end."""
    node = AsyncNode(name)
    node.create_timer(0.001, node.destroy_node)
    await node.run()


@on_loop
async def test_running_twice(name: str) -> None:
    """A node that runs can be neither entered nor run."""
    async with AsyncNode(name) as node:
        with pytest.raises(RuntimeError, match="Node is already running"):
            await node.run()
        with pytest.raises(RuntimeError, match="Node is already running"):
            async with node:
                pass


@on_loop
async def test_type_description_service(name: str) -> None:
    """The definition of a type that the node uses, with its sources."""
    async with AsyncNode(name) as node, AsyncNode(f"{name}_asks") as asker:
        node.create_publisher(String, name, 1)
        client = asker.create_client(GetTypeDescription, f"/{name}/get_type_description")
        await client.wait_for_service()
        await eventually(lambda: asker.get_publishers_info_by_topic(f"/{name}"))
        (info,) = asker.get_publishers_info_by_topic(f"/{name}")
        response = await client.call(
            GetTypeDescription.Request(
                type_name="std_msgs/msg/String",
                type_hash=str(info.topic_type_hash),
                include_type_sources=True,
            )
        )
    assert response.successful, response.failure_reason
    assert response.type_description.type_description.type_name == "std_msgs/msg/String"
    assert response.type_sources


@on_loop
async def test_graph(name: str) -> None:
    """Nodes, topics and services with their types, as the node itself sees them."""
    async with AsyncNode(name) as node:
        node.create_publisher(String, name, 1)
        node.create_service(AddTwoInts, f"{name}/add", _add)
        await node.wait_for_node(name)
        topic, service = (
            (f"/{name}", ["std_msgs/msg/String"]),
            (f"/{name}/add", ["example_interfaces/srv/AddTwoInts"]),
        )
        await eventually(lambda: topic in node.get_topic_names_and_types())
        await eventually(lambda: service in node.get_service_names_and_types())
        assert name in node.get_node_names()
        assert (name, "/") in node.get_node_names_and_namespaces()
        assert topic in node.get_publisher_names_and_types_by_node(name, "/")
        assert service in node.get_service_names_and_types_by_node(name, "/")


@on_loop
async def test_counts(name: str) -> None:
    """How many publishers, subscriptions, clients and services there are."""
    async with AsyncNode(name) as node:
        node.create_publisher(String, name, 1)
        node.create_subscription(String, name, _nothing, 1)
        node.create_service(AddTwoInts, f"{name}/add", _add)
        node.create_client(AddTwoInts, f"{name}/add")
        await eventually(lambda: node.count_publishers(name) == node.count_subscribers(name) == 1)
        await eventually(lambda: node.count_clients(f"{name}/add") == node.count_services(f"{name}/add") == 1)


@on_loop
async def test_endpoints(name: str) -> None:
    """The endpoints of a topic with their nodes."""
    async with AsyncNode(name) as node:
        node.create_publisher(String, name, 1)
        node.create_subscription(String, name, _nothing, 1)
        await eventually(lambda: node.get_publishers_info_by_topic(f"/{name}"))
        await eventually(lambda: node.get_subscriptions_info_by_topic(f"/{name}"))
        (publisher,) = node.get_publishers_info_by_topic(f"/{name}")
        (subscription,) = node.get_subscriptions_info_by_topic(f"/{name}")
    assert publisher.node_name == subscription.node_name == name
    assert publisher.topic_type == "std_msgs/msg/String"


@on_loop
async def test_another_node(name: str) -> None:
    """What a node sees of another one's entities."""
    async with AsyncNode(name) as node, AsyncNode(f"{name}_other", namespace="/far") as other:
        other.create_subscription(String, f"/{name}", _nothing, 1)
        other.create_client(AddTwoInts, f"/{name}/add")
        await node.wait_for_node(f"/far/{name}_other")
        await eventually(
            lambda: (
                (f"/{name}", ["std_msgs/msg/String"])
                in node.get_subscriber_names_and_types_by_node(f"{name}_other", "/far")
            )
        )
        await eventually(
            lambda: (
                (f"/{name}/add", ["example_interfaces/srv/AddTwoInts"])
                in node.get_client_names_and_types_by_node(f"{name}_other", "/far")
            )
        )


@on_loop
async def test_waiting_for_a_node(name: str) -> None:
    """The wait ends when the node comes, with or without a slash before its name."""
    async with AsyncNode(name) as node:
        waits = asyncio.create_task(node.wait_for_node(f"{name}_late"))
        await turns(3)
        assert not waits.done()
        async with AsyncNode(f"{name}_late"):
            await waits
            await node.wait_for_node(f"/{name}_late")


@on_loop
async def test_waiting_for_a_node_in_vain(name: str) -> None:
    """`asyncio.timeout` ends the wait."""
    async with AsyncNode(name) as node:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.05):
                await node.wait_for_node("nobody")


@pytest.mark.parametrize("what", ["publisher", "subscription", "service", "client", "timer"])
@on_loop
async def test_making_entities_on_a_destroyed_node(name: str, what: str) -> None:
    """Each is refused by name."""
    node = AsyncNode(name)
    node.destroy_node()
    make = {
        "publisher": lambda: node.create_publisher(String, name, 1),
        "subscription": lambda: node.create_subscription(String, name, _nothing, 1),
        "service": lambda: node.create_service(AddTwoInts, name, _add),
        "client": lambda: node.create_client(AddTwoInts, name),
        "timer": lambda: node.create_timer(1.0, lambda: None),
    }
    with pytest.raises(RuntimeError, match=f"Cannot create {what} on a destroyed node"):
        make[what]()


@on_loop
async def test_destroying_a_node_twice(name: str) -> None:
    """The second time nothing happens, within and after `async with`."""
    async with AsyncNode(name) as node:
        node.destroy_node()
        node.destroy_node()
    node.destroy_node()


@pytest.mark.parametrize("runs", [True, False])
@pytest.mark.parametrize("what", ["publisher", "subscription", "service", "client", "timer"])
@on_loop
async def test_destroying_an_entity_twice(name: str, what: str, runs: bool) -> None:
    """The second time nothing happens."""
    node = AsyncNode(name)
    if runs:
        await node.__aenter__()
    entity: Any = {
        "publisher": lambda: node.create_publisher(String, name, 1),
        "subscription": lambda: node.create_subscription(String, name, _nothing, 1),
        "service": lambda: node.create_service(AddTwoInts, name, _add),
        "client": lambda: node.create_client(AddTwoInts, name),
        "timer": lambda: node.create_timer(1.0, lambda: None),
    }[what]()
    await turns(2)
    entity.destroy()
    entity.destroy()
    node.destroy_node()
    entity.destroy()
    if runs:
        await node.__aexit__(None, None, None)


@on_loop
async def test_an_exception_of_the_body(name: str) -> None:
    """It comes in an ExceptionGroup, and the node and its entities are gone."""
    with pytest.raises(ExceptionGroup) as caught:
        async with AsyncNode(name) as node:
            publisher = node.create_publisher(String, name, 1)
            raise RuntimeError("of the body")
    assert str(caught.value.exceptions[0]) == "of the body"
    with pytest.raises(RuntimeError):
        publisher.publish(String())
    with pytest.raises(RuntimeError):
        node.create_publisher(String, name, 1)


@on_loop
async def test_an_exception_in_the_body_of_two_nodes(name: str) -> None:
    """Both are destroyed."""
    with pytest.raises(ExceptionGroup) as caught:
        async with AsyncNode(f"{name}_a") as a, AsyncNode(f"{name}_b") as b:
            raise RuntimeError("of the body")
    assert caught.group_contains(RuntimeError, match="of the body")
    for node in (a, b):
        with pytest.raises(RuntimeError, match="destroyed"):
            node.create_publisher(String, name, 1)


def test_shutdown_destroys_an_idle_node(name: str) -> None:
    """The context knows the node, although it never ran."""
    node = AsyncNode(name)
    rclpy.shutdown()
    with pytest.raises(RuntimeError, match="Cannot create publisher on a destroyed node"):
        node.create_publisher(String, name, 1)


@pytest.mark.parametrize("other_thread", [False, True])
@on_loop
async def test_shutdown_ends_a_running_node(name: str, other_thread: bool) -> None:
    """A callback that sleeps does not keep the node, whoever shuts down."""
    began = asyncio.Event()

    async def sleep() -> None:
        began.set()
        await asyncio.sleep(999)

    node = AsyncNode(name)
    node.create_timer(0.001, sleep)
    running = asyncio.create_task(node.run())
    await began.wait()
    if other_thread:
        thread = threading.Thread(target=rclpy.shutdown)
        thread.start()
        await running
        thread.join()
    else:
        rclpy.shutdown()
        await running


@on_loop
async def test_a_callback_destroys_its_node(name: str) -> None:
    """The callback is cancelled at its next await, and `async with` ends without an error."""
    cancelled = False
    async with AsyncNode(name) as node:

        async def destroy() -> None:
            nonlocal cancelled
            node.destroy_node()
            try:
                await asyncio.sleep(0)
            except asyncio.CancelledError:
                cancelled = True
                raise

        node.create_timer(0.001, destroy)
        await eventually(lambda: cancelled)


@on_loop
async def test_parameter_events(name: str) -> None:
    """A declared parameter is published as a new one."""
    events: list[Any] = []
    async with AsyncNode(name) as node, AsyncNode(f"{name}_hears") as hearer:
        subscription = hearer.create_subscription(
            ParameterEvent, "/parameter_events", events.append, qos_profile_parameter_events
        )
        await eventually(lambda: hearer.count_publishers("/parameter_events") >= 2)
        await eventually(lambda: subscription.get_publisher_count() >= 2)
        await eventually(lambda: _declared(node, events))
    assert all(event.node == f"/{name}" for event in events)


def _declared(node: AsyncNode, events: list[Any]) -> bool:
    # The publisher may meet the subscription later than the other way round, so that one event may get lost.
    if not events:
        node.declare_parameter(f"parameter_{len(node.list_parameters([], 0).names)}", 1)
    return any(each.name.startswith("parameter_") for event in events for each in event.new_parameters)


# Beyond upstream's


@on_loop
async def test_no_executor_takes_a_running_node(name: str) -> None:
    """An AsyncNode is no Node, and has none of what only executors serve."""
    async with AsyncNode(name) as node:
        assert not hasattr(node, "create_rate")
        assert not hasattr(node, "executor")
        executor = SingleThreadedExecutor()
        with pytest.raises((TypeError, AttributeError, RuntimeError)):
            executor.add_node(node)  # type: ignore[arg-type]  # what is tested
            executor.spin_once(timeout_sec=0)
        executor.shutdown()


@on_loop
async def test_entities_start_in_the_order_in_which_they_were_made(name: str) -> None:
    """Timers of one period are called in that order."""
    calls: list[int] = []
    node = AsyncNode(name)
    for number in range(5):
        node.create_timer(0.0, lambda number=number: calls.append(number))
    async with node:
        await eventually(lambda: len(calls) >= 5)
    assert calls[:5] == [0, 1, 2, 3, 4]


@on_loop
async def test_waits_on_a_node_that_does_not_run(name: str) -> None:
    """What nothing would end is an error that says what to do."""
    node = AsyncNode(name)
    client = node.create_client(AddTwoInts, name)
    for wait in (client.call(AddTwoInts.Request()), client.wait_for_service(), node.wait_for_node("n")):
        with pytest.raises(RuntimeError, match=f"{name}.*which does not run: write `async with node:`"):
            await wait
    node.destroy_node()


@on_loop
async def test_cancelling_run(name: str) -> None:
    """The CancelledError goes on as it is, and the node is destroyed."""
    node = AsyncNode(name)
    running = asyncio.create_task(node.run())
    await turns(2)
    running.cancel()
    with pytest.raises(asyncio.CancelledError):
        await running
    with pytest.raises(RuntimeError, match="destroyed"):
        node.create_publisher(String, name, 1)
