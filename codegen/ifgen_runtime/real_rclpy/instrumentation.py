"""Notes each endpoint of our classes when rclpy makes it, and puts a guard before it if its node wants one.

rclpy has no public event for that, and our code first runs while the first endpoint is being made:
`create_...` asks for type support, then for the `handle` of its node, and calls the constructor of Publisher,
Subscription, Client or Service afterwards. So these are wrapped: the node of what is constructed is the one
whose handle its thread has asked for last. An action adds itself to its node as a waitable, when its name is
in the graph.

A guard is a handle that looks at each message. Executors, `spin_until_future_complete` and `wait_for_message`
take from the handle, so all of them get only what the guard lets through. The experimental EventsExecutor of
rclpy takes in C++, and passes by.
"""

from __future__ import annotations

import os
import threading
import weakref
from functools import cache, wraps
from typing import TYPE_CHECKING, Any

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.client import Client
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription

from ifgen_runtime.field_types import type_name
from ifgen_runtime.interface import InterfaceMeta
from ifgen_runtime.mismatch.policy import NAME, VARIABLE, OnTypeMismatch, policy_of
from ifgen_runtime.real_rclpy.endpoints import Endpoint, Guard
from ifgen_runtime.real_rclpy.watch import watch_of

if TYPE_CHECKING:
    from collections.abc import Callable


@cache
def begin() -> None:
    """Wrap what is named above, once in a process."""
    _wrap_handle(Node)
    _wrap(Publisher, "publisher", type_at=1)
    _wrap(Subscription, "subscription", type_at=1)
    _wrap(Service, "service server", type_at=1)
    _wrap(Client, "service client", type_at=2)  # after the context
    _wrap_add_waitable(Node)


class _Asked(threading.local):
    """The node whose handle this thread has asked for last."""

    node: weakref.ref[Any] | None = None


_asked = _Asked()


def _wrap_handle(nodes: Any) -> None:
    plain = nodes.handle

    def handle(self: Any) -> Any:
        _asked.node = weakref.ref(self)
        return plain.fget(self)

    nodes.handle = property(handle, plain.fset, doc=plain.__doc__)


def _wrap(entities: Any, role: str, type_at: int) -> None:
    """Note what a constructor makes; the type is its argument at `type_at`."""
    construct = entities.__init__

    @wraps(construct)
    def construct_and_note(self: Any, *arguments: Any, **named: Any) -> None:
        cls = _interface(arguments[type_at]) if len(arguments) > type_at else None
        node = None if cls is None or _asked.node is None else _asked.node()
        if node is None or cls is None:
            construct(self, *arguments, **named)
            return
        policy, guard = node_policy(node), None
        if policy is not OnTypeMismatch.WARN and role != "publisher":
            arguments, guard = _guarded(node, role, cls, policy, arguments, named)
        if os.environ.get("IFGEN_CHECK_FIELDS") and role in {"publisher", "subscription"}:
            from ifgen_runtime.real_rclpy.guarded_subscriptions import looking  # late: few programs check

            qos = arguments[3 if role == "publisher" else 5]
            arguments = (looking(arguments[0], node, cls, arguments[2], qos), *arguments[1:])
        construct(self, *arguments, **named)
        name = self.topic_name if role in {"publisher", "subscription"} else self.service_name
        _note(node, self, role, str(name), cls, policy, guard)

    entities.__init__ = construct_and_note


def _guarded(
    node: Any,
    role: str,
    cls: type[Any],
    policy: OnTypeMismatch,
    arguments: tuple[Any, ...],
    named: dict[str, Any],
) -> tuple[tuple[Any, ...], Guard]:
    """The arguments of a constructor of rclpy with a guarded handle in them, and the guard."""
    # Late, both: only for a node that asks for it.
    from ifgen_runtime.real_rclpy.guarded_services import guarded_client, guarded_service
    from ifgen_runtime.real_rclpy.guarded_subscriptions import guarded_subscription

    match role:
        case "subscription":
            plain, message_type, topic, callback, group, qos, *rest = arguments
            subscription = guarded_subscription(node, topic, qos, cls, policy)
            called = getattr(named.get("event_callbacks"), "incompatible_type", None)
            subscription.guard.call_on_refused(called, group)
            guard: Guard = subscription.guard
            arguments = (subscription, message_type, topic, callback, group, qos, *rest)
        case "service server":
            plain, service_type, name, callback, group, qos = arguments
            service = guarded_service(node, name, qos, cls, policy)
            guard = service.guard
            arguments = (service, service_type, name, callback, group, qos)
        case _:
            context, plain, service_type, name, qos, group = arguments
            client = guarded_client(node, name, qos, cls, policy)
            guard = client.guard
            arguments = (context, client, service_type, name, qos, group)
    plain.destroy_when_not_in_use()
    return arguments, guard


def _wrap_add_waitable(nodes: Any) -> None:
    add_waitable: Callable[[Any, Any], None] = nodes.add_waitable

    @wraps(add_waitable)
    def add_and_note(self: Any, waitable: Any) -> None:
        add_waitable(self, waitable)
        cls = _interface(getattr(waitable, "_action_type", None))
        if cls is None:
            return
        role = "action client" if hasattr(waitable, "_client_handle") else "action server"
        name = _action_name(self, waitable, role, cls)
        if not name:
            text = f"cannot tell the name of an {role} of {type_name(cls)}: its clients are not looked at"
            self.get_logger().warning(text)
            return
        policy, guard = node_policy(self), None
        if policy is not OnTypeMismatch.WARN:
            from ifgen_runtime.real_rclpy.guarded_actions import guard_action  # as above

            guard = guard_action(self, waitable, role, name, cls)
        _note(self, waitable, role, name, cls, policy, guard)

    nodes.add_waitable = add_and_note


def _interface(cls: object) -> type[Any] | None:
    """The generated class that a class is, or derives from; None for compiled ones."""
    if not isinstance(cls, InterfaceMeta):
        return None
    return type(cls)._interface  # pyright: ignore[reportPrivateUsage]  # of generated classes


def node_policy(node: Any) -> OnTypeMismatch:
    """The policy of a node of rclpy. Raises ValueError for a value that is none."""
    overrides = getattr(node, "_parameter_overrides", {})  # upstream shows them in no other way
    override = overrides.get(NAME)
    if override is None and getattr(node, NAME, None) is None and not os.environ.get(VARIABLE):
        return OnTypeMismatch.WARN  # in a microsecond
    return policy_of(node, None if override is None else override.value)


def _note(
    node: Any,
    entity: Any,
    role: str,
    name: str,
    cls: type[Any],
    policy: OnTypeMismatch,
    guard: Guard | None = None,
) -> None:
    endpoint = Endpoint(weakref.ref(node), entity, role, name, cls, policy, guard)
    watch_of(node.context).note(node, endpoint)


def _action_name(node: Any, waitable: Any, role: str, cls: type[Any]) -> str:
    """The full name of an action that has just been made: a server does not know its own, and the graph does.

    It is empty if that has none.
    """
    look = get_action_client_names_and_types_by_node
    if role == "action server":
        look = get_action_server_names_and_types_by_node
    wanted = type_name(cls)
    names = [name for name, types in look(node, node.get_name(), node.get_namespace()) if wanted in types]
    if given := getattr(waitable, "_action_name", ""):  # of a client; Jazzy does not remap it
        resolved = [str(node.resolve_service_name(given, only_expand=only)) for only in (False, True)]
        names = [name for name in resolved if name in names] or resolved[1:]
    noted = {each.name for each in watch_of(node.context).endpoints_of(node) if each.role == role}
    return next((name for name in names if name not in noted), next(iter(names), ""))
