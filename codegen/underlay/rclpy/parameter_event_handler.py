"""Callbacks for changes of chosen parameters, of any node."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from itertools import chain
from typing import TYPE_CHECKING

from rcl_interfaces.msg import ParameterEvent

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.reexports import reexport
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_parameter_events
from rclpy.qos_overriding_options import QoSOverridingOptions

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter as ParameterMsg

    from rclpy.subscription import Subscription

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

_UNKNOWN = "Callback doesn't exist"


class ParameterCallbackHandle:
    """A callback for one parameter of one node; it is called by one thread at a time."""

    def __init__(self, parameter_name: str, node_name: str, callback: Callable[[ParameterMsg], None]) -> None:
        self.parameter_name = parameter_name
        self.node_name = node_name
        self.callback = callback
        self.mutex = threading.RLock()


class ParameterEventCallbackHandle:
    """A callback for every parameter event; it is called by one thread at a time."""

    def __init__(self, callback: Callable[[ParameterEvent], None]) -> None:
        self.callback = callback
        self.mutex = threading.RLock()


class ParameterEventHandler:
    """Watches /parameter_events through a subscription of `node`. The newest callback is called first."""

    class Callbacks:
        """The callbacks of a handler. They run without its lock, so they may add and remove callbacks."""

        def __init__(self) -> None:
            self.parameter_callbacks: dict[tuple[str, str], list[ParameterCallbackHandle]] = {}
            self.event_callbacks: list[ParameterEventCallbackHandle] = []
            self.mutex = threading.RLock()

        def event_callback(self, event: ParameterEvent) -> None:
            """Call whom an event concerns: first by parameter, then those who want everything."""
            with self.mutex:
                by_parameter = [(key, list(handles)) for key, handles in self.parameter_callbacks.items()]
                for_all = list(self.event_callbacks)
            for (parameter_name, node_name), handles in by_parameter:
                parameter = ParameterEventHandler.get_parameter_from_event(event, parameter_name, node_name)
                if parameter is not None:
                    for handle in handles:
                        with handle.mutex:
                            handle.callback(parameter)
            for event_handle in for_all:
                with event_handle.mutex:
                    event_handle.callback(event)

        def add_parameter_callback(
            self, parameter_name: str, node_name: str, callback: Callable[[ParameterMsg], None]
        ) -> ParameterCallbackHandle:
            """Call `callback` when the parameter is new or set."""
            handle = ParameterCallbackHandle(parameter_name, node_name, callback)
            with self.mutex:
                self.parameter_callbacks.setdefault((parameter_name, node_name), []).insert(0, handle)
            return handle

        def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
            """Call it no longer; raises RuntimeError if it is unknown."""
            key = (handle.parameter_name, handle.node_name)
            with self.mutex:
                handles = self.parameter_callbacks.get(key, [])
                if handle not in handles:
                    raise RuntimeError(_UNKNOWN)
                handles.remove(handle)
                if not handles:
                    del self.parameter_callbacks[key]

        def add_parameter_event_callback(
            self, callback: Callable[[ParameterEvent], None]
        ) -> ParameterEventCallbackHandle:
            """Call `callback` with every event."""
            handle = ParameterEventCallbackHandle(callback)
            with self.mutex:
                self.event_callbacks.insert(0, handle)
            return handle

        def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
            """Call it no longer; raises RuntimeError if it is unknown."""
            with self.mutex:
                if handle not in self.event_callbacks:
                    raise RuntimeError(_UNKNOWN)
                self.event_callbacks.remove(handle)

    def __init__(
        self,
        node: Node,
        qos_profile: QoSProfile = qos_profile_parameter_events,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> None:
        self.node = node
        self.qos_profile = qos_profile
        self._callbacks = ParameterEventHandler.Callbacks()
        subscribe: Callable[..., Subscription[ParameterEvent]] = node.create_subscription  # any `raw`
        self.parameter_event_subscription: Subscription[ParameterEvent] = subscribe(
            ParameterEvent,
            "/parameter_events",
            self._callbacks.event_callback,
            self.qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def destroy(self) -> None:
        """Stop watching."""
        self.node.destroy_subscription(self.parameter_event_subscription)

    @staticmethod
    def get_parameter_from_event(
        event: ParameterEvent, parameter_name: str, node_name: str
    ) -> ParameterMsg | None:
        """Return a parameter that is new or changed on `node_name` (full name) as a message, or None."""
        if event.node != node_name:
            return None
        parameters = ParameterEventHandler.get_parameters_from_event(event)
        return next((parameter for parameter in parameters if parameter.name == parameter_name), None)

    @staticmethod
    def get_parameters_from_event(event: ParameterEvent) -> Iterable[ParameterMsg]:
        """Iterate over the new and then the changed parameters of an event."""
        yield from chain(event.new_parameters, event.changed_parameters)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[ParameterMsg], None]
    ) -> ParameterCallbackHandle:
        """Call `callback` when the parameter of a node (the own one if empty) is new or set."""
        return self._callbacks.add_parameter_callback(parameter_name, self._resolve_path(node_name), callback)

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        """Call it no longer; raises RuntimeError if it is unknown."""
        self._callbacks.remove_parameter_callback(handle)

    def add_parameter_event_callback(
        self, callback: Callable[[ParameterEvent], None]
    ) -> ParameterEventCallbackHandle:
        """Call `callback` with every event of every node."""
        return self._callbacks.add_parameter_event_callback(callback)

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        """Call it no longer; raises RuntimeError if it is unknown."""
        self._callbacks.remove_parameter_event_callback(handle)

    def _resolve_path(self, node_path: str | None = None) -> str:
        """Make the name of a node absolute: relative ones are in the own node's namespace."""
        if not node_path:
            return self.node.get_fully_qualified_name()
        if node_path.startswith("/"):
            return node_path
        namespace = self.node.get_namespace().strip("/")
        return f"/{namespace}/{node_path}" if namespace else f"/{node_path}"
