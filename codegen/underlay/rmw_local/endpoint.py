"""Readers and writers: what they have in common, and all endpoints of one kind on a topic or a service."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

from rmw_local.status import IncompatibleQosStatus, IncompatibleTypeStatus, MatchedStatus

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.qos import QosProfile


class Endpoint:
    """One end of a topic. Its QoS profile is resolved: no policy is "system default" any more."""

    role: ClassVar[str]
    is_remote: ClassVar[bool] = False
    """Whether it stands for an endpoint in another process."""
    encounters: tuple[Encounter, ...] = ()  # with other definitions, until they are told of

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        self.node = node
        self.message_type = message_type
        self.topic = topic
        self.qos = qos
        self.gid = node.participant.next_gid()
        self.closed = False
        self.matched = MatchedStatus()
        self.incompatible_qos = IncompatibleQosStatus()
        self.incompatible_type = IncompatibleTypeStatus()

    @property
    def kind(self) -> MessageType:
        """Its type, as services and topics both have one."""
        return self.message_type

    @property
    def name(self) -> str:
        """The name of its topic."""
        return self.topic


class _End(Protocol):
    @property
    def is_remote(self) -> bool: ...


E = TypeVar("E", bound=_End)


class Ends(Generic[E]):
    """Endpoints in the order in which they came, those here before those in other processes.

    Others may have tens of thousands, so each of them comes and goes in constant time.
    """

    def __init__(self) -> None:
        self._near: dict[E, None] = {}
        self._far: dict[E, None] = {}

    def __iter__(self) -> Iterator[E]:
        return chain(self._near, self._far)

    def __bool__(self) -> bool:
        return bool(self._near or self._far)

    def add(self, end: E) -> None:
        """Let an endpoint join."""
        (self._far if end.is_remote else self._near)[end] = None

    def remove(self, end: E) -> None:
        """Let it leave."""
        del (self._far if end.is_remote else self._near)[end]

    def facing(self, other: _End) -> Iterable[E]:
        """Those whom an endpoint of the other kind can meet here: two from elsewhere meet where they are."""
        return self._near if other.is_remote else self
