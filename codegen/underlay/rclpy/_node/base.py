"""What every part of a node stands on: its handle, its context, its executor and what it owns."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import rclpy.node  # its names are looked up there at each call: tests put others in their place
from rclpy.exceptions import NotInitializedException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.client import Client
    from rclpy.clock import Clock
    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.guard_condition import GuardCondition
    from rclpy.impl.rcutils_logger import RcutilsLogger
    from rclpy.publisher import Publisher
    from rclpy.service import Service
    from rclpy.subscription import Subscription
    from rclpy.timer import Timer
    from rclpy.waitable import Waitable


class NodeBase:
    """A named handle in a context that owns entities and may belong to one executor.

    Users derive from nodes and give their attributes any name, so what is not upstream's name has two
    underscores.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None,
        cli_args: list[str] | None,
        namespace: str | None,
        use_global_arguments: bool,
        enable_rosout: bool,
    ) -> None:
        self._context = rclpy.node.get_default_context() if context is None else context
        self._publishers: list[Publisher[Any]] = []
        self._subscriptions: list[Subscription[Any]] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers: list[Timer] = []
        self._guards: list[GuardCondition] = []
        self.__waitables: list[Waitable] = []
        self._default_callback_group = rclpy.node.MutuallyExclusiveCallbackGroup()
        self._rate_group = rclpy.node.ReentrantCallbackGroup()
        self.__executor_weakref: weakref.ref[Executor] | None = None
        self._clock: Clock

        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        namespace = namespace or ""
        try:
            with self._context.handle:
                self.__node: Any = _rclpy.Node(
                    node_name, namespace, self._context.handle, cli_args, use_global_arguments, enable_rosout
                )
        except ValueError:
            # These say which character is wrong.
            rclpy.node.validate_node_name(node_name)
            rclpy.node.validate_namespace(namespace if namespace.startswith("/") else f"/{namespace}")
            raise
        with self.__node:
            self._logger = rclpy.node.get_logger(self.__node.logger_name())

    @property
    def publishers(self) -> Iterator[Publisher[Any]]:
        """Iterate over the publishers of this node."""
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Subscription[Any]]:
        """Iterate over the subscriptions of this node."""
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Client]:
        """Iterate over the service clients of this node."""
        yield from self._clients

    @property
    def services(self) -> Iterator[Service]:
        """Iterate over the services of this node."""
        yield from self._services

    @property
    def timers(self) -> Iterator[Timer]:
        """Iterate over the timers of this node."""
        yield from self._timers

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """Iterate over the guard conditions of this node."""
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Waitable]:
        """Iterate over the waitables of this node: QoS events, actions, and those that users added."""
        yield from self.__waitables

    @property
    def executor(self) -> Executor | None:
        """The executor that the node belongs to; setting it takes the node out of the one before."""
        return None if self.__executor_weakref is None else self.__executor_weakref()

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        node: Any = self
        current = self.executor
        if current == new_executor:
            return
        if current is not None:
            current.remove_node(node)
        if new_executor is None:
            self.__executor_weakref = None
        else:
            new_executor.add_node(node)
            self.__executor_weakref = weakref.ref(new_executor)

    def _wake_executor(self) -> None:
        """Let the executor see that the node's entities have changed."""
        executor = self.executor
        if executor is not None:
            executor.wake()

    @property
    def context(self) -> Context:
        """The context the node was made in."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The mutually exclusive group of every entity that was created without one."""
        return self._default_callback_group

    @property
    def handle(self) -> Any:
        """The handle below; it cannot be replaced (AttributeError)."""
        return self.__node

    @handle.setter
    def handle(self, value: Any) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def get_name(self) -> str:
        """Return the name, remapped."""
        with self.handle:
            name: str = self.handle.get_node_name()
            return name

    def get_namespace(self) -> str:
        """Return the namespace, remapped and absolute."""
        with self.handle:
            namespace: str = self.handle.get_namespace()
            return namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name in one."""
        with self.handle:
            full_name: str = self.handle.get_fully_qualified_name()
            return full_name

    def get_clock(self) -> Clock:
        """Return the node's clock, which follows ROS time."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the logger with the node's name."""
        return self._logger

    def add_waitable(self, waitable: Waitable) -> None:
        """Let the executor wait for something beyond the node's own entities."""
        self.__waitables.append(waitable)
        self._wake_executor()

    def remove_waitable(self, waitable: Waitable) -> None:
        """Stop waiting for it; raises ValueError for one that was never added."""
        self.__waitables.remove(waitable)
        self._wake_executor()
