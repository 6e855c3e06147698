"""Classes that the fixtures return: factories of nodes and of collectors."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import pytest

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

MessageType = TypeVar("MessageType")


class NodeFactory:
    """Makes nodes, lets an executor run them, destroys them."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._nodes: list[Node] = []

    def __call__(self, kind: str | Callable[..., Node] = "test_node", *args: Any, **kwargs: Any) -> Node:
        """Make a node: of a name, or whatever a class or function returns; the rest goes there."""
        if isinstance(kind, str):
            from rclpy.node import Node  # imported when a test asks

            node = Node(kind, *args, **kwargs)
        else:
            node = kind(*args, **kwargs)
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def destroy(self) -> None:
        """Destroy all nodes, the newest first; one that the test has destroyed stays so."""
        while self._nodes:
            node = self._nodes.pop()
            self._executor.remove_node(node)
            node.destroy_node()


class Collector(Generic[MessageType]):
    """Keeps what arrives on a topic, in `messages`."""

    def __init__(
        self, executor: Executor, node: Node, type_: type[MessageType], topic: str, qos: QoSProfile | int
    ) -> None:
        self.messages: list[MessageType] = []
        self._executor = executor
        self._subscription = node.create_subscription(type_, topic, self.messages.append, qos)
        self._node = node

    def wait(self, count: int = 1, timeout: float = 5.0) -> list[MessageType]:
        """Spin until `count` or more messages are there, and return them all.

        Fails the test after `timeout` s.
        """
        __tracebackhide__ = True
        if not self._spin_until(lambda: len(self.messages) >= count, timeout):
            got = f"{len(self.messages)}: {self.messages}" if self.messages else "none"
            pytest.fail(
                f"expected {count} message(s) on {self._topic} within {timeout:g} s, got {got}\n"
                f"publishers there: {self._publishers()}"
            )
        return list(self.messages)

    def wait_for_publishers(self, count: int = 1, timeout: float = 5.0) -> None:
        """Spin until the given number of publishers are matched; fail the test after `timeout` s.

        Publish after this: real DDS takes a while to match, and drops what is published before.
        """
        __tracebackhide__ = True
        if not self._spin_until(lambda: self._publishers() >= count, timeout):
            pytest.fail(
                f"expected {count} publisher(s) on {self._topic} within {timeout:g} s, "
                f"got {self._publishers()}"
            )

    def expect_none(self, during: float = 0.5) -> None:
        """Spin for the given seconds; fail the test if anything (more) arrives."""
        __tracebackhide__ = True
        before = len(self.messages)
        if self._spin_until(lambda: len(self.messages) > before, during):
            pytest.fail(f"expected no message on {self._topic}, got {self.messages[before:]}")

    def clear(self) -> None:
        """Forget what has arrived."""
        self.messages.clear()

    @property
    def _topic(self) -> str:
        return str(self._subscription.topic_name)

    def _publishers(self) -> int:
        return int(self._node.count_publishers(self._topic))

    def _spin_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        until = time.monotonic() + timeout
        while not condition():
            left = until - time.monotonic()
            if left <= 0:
                return False
            # In steps, because nothing wakes the executor when the graph changes.
            self._executor.spin_once(timeout_sec=min(left, 0.05))
        return True


class CollectorFactory:
    """Makes collectors, all on one node of their own."""

    def __init__(self, executor: Executor, make_node: NodeFactory) -> None:
        self._executor = executor
        self._make_node = make_node
        self._node: Node | None = None

    def __call__(
        self, type_: type[MessageType], topic: str, qos: QoSProfile | int = 10
    ) -> Collector[MessageType]:
        """Collect the messages of a topic; `qos` is a profile or a depth."""
        if self._node is None:
            self._node = self._make_node("ros_collect")
        return Collector(self._executor, self._node, type_, topic, qos)
