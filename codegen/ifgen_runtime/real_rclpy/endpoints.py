"""An endpoint of our never-compiled classes, and the DDS topics that it consists of."""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

from rclpy.exceptions import InvalidHandle

from ifgen_runtime.field_types import type_name
from ifgen_runtime.mismatch.policy import OnTypeMismatch

if TYPE_CHECKING:
    from ifgen_runtime.real_rclpy.peers import Peer

_OTHERS: Final = {
    "publisher": "subscription",
    "subscription": "publisher",
    "service client": "service server",
    "service server": "service client",
    "action client": "action server",
    "action server": "action client",
}

_COUNTS: Final = {
    "publisher": "get_count_subscribers",
    "subscription": "get_count_publishers",
    "service client": "get_count_services",
    "service server": "get_count_clients",
    "action client": "get_count_publishers",
    "action server": "get_count_subscribers",
}


@dataclass(frozen=True, slots=True)
class Part:
    """One topic of DDS that an endpoint writes or reads.

    `topic` is the name with DDS's prefix. `cls` is the class of what goes over it. `written` says whether
    our endpoint writes: then the others read.
    """

    topic: str
    cls: type[Any]
    written: bool

    @property
    def is_message(self) -> bool:
        """Whether it is a topic of ROS, and no part of a service."""
        return not self.topic.startswith(("rq/", "rr/"))

    @property
    def type_name(self) -> str:
        """`pkg/msg/Name` of the class, as the graph of ROS spells it."""
        return type_name(self.cls)

    @property
    def type_hash(self) -> str:
        """`RIHS01_...` of the class."""
        return str(self.cls.__type_hash__)


class Guard(Protocol):
    """Decides about each message that an endpoint sends or receives."""

    must_agree: bool
    """Whether messages are let through only while all others have one definition."""

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all whom the endpoint meets now."""

    def end(self) -> None:
        """The endpoint has been destroyed."""


class Endpoint:
    """A publisher, a subscription, or a client or server of a service or an action.

    It refers weakly to rclpy's objects, which are the user's to destroy. Making one takes a few microseconds:
    what only a look needs is found then.
    """

    __slots__ = (
        "_entity",
        "_parts",
        "cls",
        "count_by",
        "counted",
        "differing",
        "guard",
        "name",
        "node_of",
        "policy",
        "role",
        "seen",
        "tries",
    )

    def __init__(
        self,
        node: weakref.ref[Any],
        entity: Any,
        role: str,
        name: str,
        cls: type[Any],
        policy: OnTypeMismatch,
        guard: Guard | None = None,
    ) -> None:
        self.node_of = node
        self._entity = weakref.ref(entity)
        self._parts: tuple[Part, ...] = ()
        self.role = role
        self.name = name
        self.cls = cls
        self.policy = policy
        self.count_by = _COUNTS[role]
        """The method of a node's handle that counts the others, whatever their definition."""
        self.counted = f"{name}/_action/feedback" if role.startswith("action") else name
        """The name that they are counted by."""
        self.seen = -1
        """How many others there were at the last look."""
        self.guard = guard
        """The guard that keeps messages of other definitions from it, if its node's policy asks for one."""
        self.differing: tuple[str, ...] = ()
        """The names of the nodes whose definitions differed, the last time that there were any."""
        self.tries = 0
        """How many looks in a row have found somebody whose node has no name yet."""

    @property
    def parts(self) -> tuple[Part, ...]:
        """The topics of DDS that it consists of."""
        if not self._parts:
            self._parts = parts_of(self.role, self.name, self.cls, getattr(self.entity, "qos_profile", None))
        return self._parts

    @property
    def node_name(self) -> str:
        """The full name of its node. Raises InvalidHandle where that has been destroyed."""
        return str(self.node.get_fully_qualified_name())

    @property
    def kind(self) -> str:
        """`topic`, `service` or `action`."""
        kind = self.role.partition(" ")[0]
        return kind if kind in {"service", "action"} else "topic"

    @property
    def others(self) -> str:
        """The role of those whom this endpoint meets."""
        return _OTHERS[self.role]

    @property
    def receives(self) -> bool:
        """Whether it is on the side that decodes first."""
        return self.role in {"subscription", "service server", "action client"}

    @property
    def node(self) -> Any:
        """The node; None if it is gone."""
        return self.node_of()

    @property
    def entity(self) -> Any:
        """The publisher, subscription, client and so on; None if it is gone."""
        return self._entity()

    def is_alive(self) -> bool:
        """Whether it exists, and neither it nor its node has been destroyed."""
        entity, node = self.entity, self.node
        if entity is None or node is None:
            return False
        try:
            with node.handle, _handle(entity):
                return True
        except InvalidHandle:
            return False

    def is_connected(self) -> bool:
        """Whether the middleware has connected it with anybody; True where it does not say."""
        entity = self.entity
        match self.role:
            case "publisher":
                return bool(entity.get_subscription_count())
            case "subscription":
                return bool(entity.get_publisher_count())
            case "service client" if self.guard is None:
                return bool(entity.service_is_ready())
            case "action client" if self.guard is None:
                return bool(entity.server_is_ready())
            case _:
                return True


def _handle(entity: Any) -> Any:
    """The handle of rclpy. Those of actions have no public name."""
    for name in ("handle", "_client_handle", "_handle"):
        if (handle := getattr(entity, name, None)) is not None:
            return handle
    raise AttributeError(f"{type(entity).__name__} has no handle")


def parts_of(role: str, name: str, cls: type[Any], qos: Any) -> tuple[Part, ...]:
    """The parts of an endpoint. `qos` is rclpy's profile of a topic, None for actions."""
    kind, _, side = role.partition(" ")
    if kind == "service":
        return tuple(_service_parts(name, cls, asks=side == "client"))
    if kind == "action":
        return tuple(_action_parts(name, cls, asks=side == "client"))
    prefix = "" if getattr(qos, "avoid_ros_namespace_conventions", False) else "rt"
    return (Part(f"{prefix}{name}", cls, written=role == "publisher"),)


def _service_parts(name: str, cls: type[Any], *, asks: bool) -> Iterator[Part]:
    yield Part(f"rq{name}Request", cls.Request, written=asks)
    yield Part(f"rr{name}Reply", cls.Response, written=not asks)


def _action_parts(name: str, cls: type[Any], *, asks: bool) -> Iterator[Part]:
    yield Part(f"rt{name}/_action/feedback", cls.Impl.FeedbackMessage, written=not asks)
    yield from _service_parts(f"{name}/_action/send_goal", cls.Impl.SendGoalService, asks=asks)
    yield from _service_parts(f"{name}/_action/get_result", cls.Impl.GetResultService, asks=asks)
