"""Notes each endpoint of our classes when rclpy makes it.

It has no public event for that, and our code first runs while the first endpoint is being made: `create_...`
asks for type support, and calls the constructor of Publisher, Subscription, Client or Service afterwards. So
these are wrapped, and the node is the `self` of the method that calls them. An action adds itself to its node
as a waitable, when the name that it was made with is in its constructor's frame.
"""

from __future__ import annotations

import inspect
import os
import weakref
from functools import cache, wraps
from types import FrameType
from typing import TYPE_CHECKING, Any, Final

from rclpy.client import Client
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription

from ifgen_runtime.interface import InterfaceMeta
from ifgen_runtime.mismatch.policy import NAME, VARIABLE, OnTypeMismatch, policy_of
from ifgen_runtime.mismatch.real_rclpy.endpoints import Endpoint, Guard
from ifgen_runtime.mismatch.real_rclpy.watch import watch_of

if TYPE_CHECKING:
    from collections.abc import Callable

_FRAMES: Final = (
    4  # between a constructor and its node: a class that derives from rclpy's, such as LifecyclePublisher
)


@cache
def begin() -> None:
    """Wrap rclpy's constructors, once in a process."""
    _wrap(Publisher, "publisher", type_at=1)
    _wrap(Subscription, "subscription", type_at=1)
    _wrap(Service, "service server", type_at=1)
    _wrap(Client, "service client", type_at=2)  # after the context
    _wrap_add_waitable(Node)


def _wrap(entities: Any, role: str, type_at: int) -> None:
    """Note what a constructor makes; the type is its argument at `type_at`."""
    construct = entities.__init__

    @wraps(construct)
    def construct_and_note(self: Any, *arguments: Any, **named: Any) -> None:
        cls = _interface(arguments[type_at]) if len(arguments) > type_at else None
        node = None if cls is None else _node_of(_caller())
        if node is None or cls is None:
            construct(self, *arguments, **named)
            return
        policy, guard = node_policy(node), None
        if policy is not OnTypeMismatch.WARN and role != "publisher":
            from ifgen_runtime.mismatch.real_rclpy.guarding import guarded  # only where somebody asks for it

            arguments, guard = guarded(node, role, cls, policy, arguments, named)
        construct(self, *arguments, **named)
        _note(node, self, role, _name(self, role), cls, policy, guard)

    entities.__init__ = construct_and_note


def _wrap_add_waitable(nodes: Any) -> None:
    add_waitable: Callable[[Any, Any], None] = nodes.add_waitable

    @wraps(add_waitable)
    def add_and_note(self: Any, waitable: Any) -> None:
        add_waitable(self, waitable)
        cls = _interface(getattr(waitable, "_action_type", None))
        if cls is not None:
            frame = _frame_with(_caller(), "action_name")
            if frame is not None:
                role = "action client" if hasattr(waitable, "_client_handle") else "action server"
                name = _action_name(self, role, frame.f_locals["action_name"])
                policy, guard = node_policy(self), None
                if policy is not OnTypeMismatch.WARN:
                    from ifgen_runtime.mismatch.real_rclpy.guarded_action import guard_action  # as above

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


def _action_name(node: Any, role: str, name: str) -> str:
    """The full name of an action, which Jazzy does not remap."""
    remapped = str(node.resolve_service_name(name))
    count = node.count_subscribers if role == "action client" else node.count_publishers
    if count(f"{remapped}/_action/feedback"):
        return remapped
    return str(node.resolve_service_name(name, only_expand=True))


def _name(entity: Any, role: str) -> str:
    if role in {"publisher", "subscription"}:
        return str(entity.topic_name)
    return str(entity.service_name)


def _caller() -> FrameType | None:
    """The frame of whoever has called the function that asks."""
    frame = inspect.currentframe()
    return None if frame is None or frame.f_back is None else frame.f_back.f_back


def _node_of(frame: FrameType | None) -> Any:
    """The node whose method this frame, or one that called it, runs; None if there is none."""
    for _ in range(_FRAMES):
        if frame is None:
            break
        found = frame.f_locals.get("self")
        if isinstance(found, Node):
            return found
        frame = frame.f_back
    return None


def _frame_with(frame: FrameType | None, name: str) -> FrameType | None:
    for _ in range(_FRAMES):
        if frame is None or name in frame.f_locals:
            return frame
        frame = frame.f_back
    return None
