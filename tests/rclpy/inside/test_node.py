"""Deliberate improvements of our nodes over upstream's, and behaviour that shows only from inside."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator

import pytest
import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_event_handler import ParameterEventHandler
from std_msgs.msg import String


@pytest.fixture(autouse=True)
def _context() -> Iterator[None]:
    rclpy.init(args=[])
    yield
    rclpy.try_shutdown()


def test_an_undeclared_parameter_is_named() -> None:
    """Upstream's text has an empty list."""
    node = Node("n")
    with pytest.raises(ParameterNotDeclaredException, match="zz"):
        node.set_parameters([Parameter("zz", value=1)])


def test_an_impossible_transition_does_not_kill_the_node() -> None:
    """Upstream's service raises out of the node's own spin."""
    managed, client = LifecycleNode("managed"), Node("client")
    caller = client.create_client(ChangeState, "managed/change_state")
    executor = SingleThreadedExecutor()
    executor.add_node(managed)
    executor.add_node(client)
    for number, success in ((3, False), (77, False), (1, True), (1, False)):
        future = caller.call_async(ChangeState.Request(transition=Transition(id=number)))
        executor.spin_until_future_complete(future, 5)
        assert future.result().success is success


def test_a_parameter_callback_may_change_the_callbacks() -> None:
    """Upstream's handler would deadlock."""
    node = Node("n")
    node.declare_parameter("a", 0)
    handler = ParameterEventHandler(node)
    heard: list[str] = []

    def once(_: object) -> None:
        heard.append("once")
        handler.remove_parameter_callback(handle)
        handler.add_parameter_callback("a", "n", lambda _: heard.append("then"))

    handle = handler.add_parameter_callback("a", "n", once)
    for value in (1, 2):
        node.set_parameters([Parameter("a", value=value)])
        rclpy.spin_once(node, timeout_sec=1)
    assert heard == ["once", "then"]


def test_waiting_for_a_node_ends_when_it_comes() -> None:
    """The graph ends the wait; it does not poll until the limit."""
    node = Node("waiting")
    answers: list[bool] = []
    thread = threading.Thread(target=lambda: answers.append(node.wait_for_node("late", 30)))
    thread.start()
    late = Node("late")
    thread.join(10)
    assert answers == [True]
    late.destroy_node()


@pytest.mark.parametrize("destroy", [True, False])
def test_nodes_leave_the_graph_and_memory(destroy: bool) -> None:
    """A hundred nodes leave nothing, whether they are destroyed or forgotten."""
    watcher = Node("watcher")
    references = []
    for number in range(100):
        node = Node(f"gone{number}")
        node.create_publisher(String, f"t{number}", 10)
        node.declare_parameter("a", 1, ParameterDescriptor(dynamic_typing=True))
        references.append(weakref.ref(node))
        if destroy:
            node.destroy_node()
    del node
    gc.collect()
    assert [each() for each in references if each() is not None] == []
    names = watcher.get_node_names()
    assert [name for name in names if name.startswith("gone")] == []
    assert [name for name, _ in watcher.get_topic_names_and_types() if name.startswith("/t")] == []


def test_entities_come_and_go_from_many_threads() -> None:
    """Creating and destroying entities on four threads leaves only those of a bare node."""
    node = Node("busy")
    bare = [len(list(each)) for each in (node.publishers, node.subscriptions, node.timers, node.waitables)]
    errors: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(50):
                publisher = node.create_publisher(String, "t", 10)
                subscription = node.create_subscription(String, "t", lambda _: None, 10)
                timer = node.create_timer(1.0, lambda: None)
                publisher.publish(String(data="x"))
                assert node.destroy_timer(timer)
                assert node.destroy_subscription(subscription)
                assert node.destroy_publisher(publisher)
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert errors == []
    assert [
        len(list(each)) for each in (node.publishers, node.subscriptions, node.timers, node.waitables)
    ] == bare


def test_users_may_call_their_attributes_as_they_like() -> None:
    """Names that upstream leaves free are free here."""

    class Counter(Node):
        def __init__(self) -> None:
            super().__init__("counter")
            for name in (
                "_count",
                "_handle",
                "_own",
                "_destroy",
                "_store",
                "_waitables",
                "_rules",
                "_executor",
                "_state",
            ):
                setattr(self, name, 0)

    node = Counter()
    publisher = node.create_publisher(String, "t", 10)
    assert node.count_publishers("t") == 1
    node.declare_parameter("a", 1)
    rclpy.spin_once(node, timeout_sec=0)
    assert node.destroy_publisher(publisher)
    node.destroy_node()
