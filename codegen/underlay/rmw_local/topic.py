"""A topic: its writers and readers, and their matching."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rmw_local import observer
from rmw_local.endpoint import Ends
from rmw_local.qos import mismatch

if TYPE_CHECKING:
    from rmw_local.endpoint import Endpoint
    from rmw_local.reader import Reader
    from rmw_local.ready import ReadySource
    from rmw_local.writer import Writer


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
