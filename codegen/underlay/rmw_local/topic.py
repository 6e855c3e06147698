"""Topics: their writers and readers, what these have in common, and how they are matched."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

from rmw_local import observer
from rmw_local.qos import mismatch
from rmw_local.status import IncompatibleQosStatus, IncompatibleTypeStatus, MatchedStatus

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.qos import QosProfile
    from rmw_local.reader import Reader
    from rmw_local.ready import ReadySource
    from rmw_local.writer import Writer


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
        self._local: dict[E, None] = {}
        self._remote: dict[E, None] = {}

    def __iter__(self) -> Iterator[E]:
        return chain(self._local, self._remote)

    def __bool__(self) -> bool:
        return bool(self._local or self._remote)

    def add(self, end: E) -> None:
        """Let an endpoint join."""
        (self._remote if end.is_remote else self._local)[end] = None

    def remove(self, end: E) -> None:
        """Let it leave."""
        del (self._remote if end.is_remote else self._local)[end]

    def facing(self, other: _End) -> Iterable[E]:
        """Those whom an endpoint of the other kind can meet here: two from elsewhere meet where they are."""
        return self._local if other.is_remote else self


class Topic:
    """All endpoints of one topic name in one domain. Every method is called with the domain's lock held.

    Methods return the sources to notify once the lock is released.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.writers: Ends[Writer] = Ends()
        self.readers: Ends[Reader] = Ends()
        self._refused: dict[Reader, set[Writer]] = {}  # by readers of this process: their definitions differ

    def add_writer(self, writer: Writer) -> list[ReadySource]:
        """Let a writer join."""
        changed: list[ReadySource] = []
        for reader in self.readers.facing(writer):
            changed += self._introduce(writer, reader, newcomer=writer)
        self.writers.add(writer)
        return changed

    def add_reader(self, reader: Reader) -> list[ReadySource]:
        """Let a reader join; it gets what durable writers have kept."""
        changed: list[ReadySource] = []
        for writer in self.writers.facing(reader):
            changed += self._introduce(writer, reader, newcomer=reader)
        self.readers.add(reader)
        if reader.is_ready():
            changed.append(reader)
        return changed

    def remove_writer(self, writer: Writer) -> list[ReadySource]:
        """Let a writer leave."""
        self.writers.remove(writer)
        changed: list[ReadySource] = []
        for reader in writer.matches:
            changed += self._part(writer, reader, stays=reader)
        if self._refused:
            changed += self._readmit(writer)
        return changed

    def remove_reader(self, reader: Reader) -> list[ReadySource]:
        """Let a reader leave."""
        self.readers.remove(reader)
        changed: list[ReadySource] = []
        for writer in self.writers.facing(reader):
            if writer.reaches(reader):
                changed += self._part(writer, reader, stays=writer)
        self._refused.pop(reader, None)
        return changed

    def is_empty(self) -> bool:
        """True if no endpoint is left."""
        return not self.writers and not self.readers

    def _introduce(self, writer: Writer, reader: Reader, *, newcomer: Endpoint) -> list[ReadySource]:
        if writer.message_type.name != reader.message_type.name:
            return []  # DDS keeps topics of different types apart without a word
        if writer.qos.avoid_ros_namespace_conventions != reader.qos.avoid_ros_namespace_conventions:
            return []  # in DDS one of them has a prefix to its name
        are_equal = writer.message_type.type_hash == reader.message_type.type_hash
        policy_kind = mismatch(writer.qos, reader.qos)
        if reader.stands_in and (policy_kind is not None or not are_equal):
            return []  # whom it stands for has met this writer
        if policy_kind is not None:
            return _refuse_qos(writer, reader, policy_kind)
        origin = None
        if not are_equal:
            from rmw_local.mismatch.encounter import meet_on_topic  # late: definitions hardly ever differ

            encounter, origin = meet_on_topic(writer, reader)
            newcomer.encounters = (*newcomer.encounters, encounter)
            if origin is None:
                return self._refuse(writer, reader, withholds=encounter.withholds)
        writer.connect(reader, origin)
        writer.matched.joined()
        reader.matched.joined()
        return [writer.matched, reader.matched, reader.liveliness_changed]

    def _refuse(self, writer: Writer, reader: Reader, *, withholds: bool) -> list[ReadySource]:
        """Part two endpoints; if it `withholds`, keep the reader from everything until the writer leaves."""
        if withholds:
            self._refused.setdefault(reader, set()).add(writer)
            reader.withhold()
        writer.incompatible_type.add()
        reader.incompatible_type.add()
        return [writer.incompatible_type, reader.incompatible_type]

    def _readmit(self, writer: Writer) -> list[ReadySource]:
        """Release the readers that refused nobody else than this writer."""
        free = [reader for reader, refused in self._refused.items() if refused == {writer}]
        for refused in self._refused.values():
            refused.discard(writer)
        for reader in free:
            del self._refused[reader]
            reader.release()
        return [reader for reader in free if reader.is_ready()]

    def _part(self, writer: Writer, reader: Reader, *, stays: Endpoint) -> list[ReadySource]:
        writer.disconnect(reader)
        stays.matched.left()  # an endpoint is not notified of its own end
        return [stays.matched, reader.liveliness_changed]


def _refuse_qos(writer: Writer, reader: Reader, policy_kind: int) -> list[ReadySource]:
    watching = observer.current()
    if watching is not None:
        watching.incompatible_qos(writer.topic, policy_kind, writer.node.full_name, reader.node.full_name)
    writer.incompatible_qos.refuse(policy_kind)
    reader.incompatible_qos.refuse(policy_kind)
    return [writer.incompatible_qos, reader.incompatible_qos]
