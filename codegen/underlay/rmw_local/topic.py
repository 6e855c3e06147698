"""A topic: its writers and readers, and their matching."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rmw_local import observer
from rmw_local.message import difference
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
        self.writers: list[Writer] = []
        self.readers: list[Reader] = []

    def add_writer(self, writer: Writer) -> list[ReadySource]:
        """Let a writer join."""
        changed: list[ReadySource] = []
        for reader in self.readers:
            changed += self._introduce(writer, reader, newcomer=writer)
        self.writers.append(writer)
        return changed

    def add_reader(self, reader: Reader) -> list[ReadySource]:
        """Let a reader join; it gets what durable writers have kept."""
        changed: list[ReadySource] = []
        for writer in self.writers:
            changed += self._introduce(writer, reader, newcomer=reader)
        self.readers.append(reader)
        if reader.is_ready():
            changed.append(reader)
        return changed

    def remove_writer(self, writer: Writer) -> list[ReadySource]:
        """Let a writer leave."""
        self.writers.remove(writer)
        changed: list[ReadySource] = []
        for reader in writer.readers:
            changed += self._part(writer, reader, stays=reader)
        return changed

    def remove_reader(self, reader: Reader) -> list[ReadySource]:
        """Let a reader leave."""
        self.readers.remove(reader)
        changed: list[ReadySource] = []
        for writer in self.writers:
            if reader in writer.readers:
                changed += self._part(writer, reader, stays=writer)
        return changed

    def is_empty(self) -> bool:
        """True if no endpoint is left."""
        return not self.writers and not self.readers

    def _introduce(self, writer: Writer, reader: Reader, *, newcomer: Endpoint) -> list[ReadySource]:
        if writer.message_type.name != reader.message_type.name:
            return []  # DDS keeps topics of different types apart without a word
        if writer.qos.avoid_ros_namespace_conventions != reader.qos.avoid_ros_namespace_conventions:
            return []  # in DDS one of them has a prefix to its name
        explanation = difference(writer.message_type, reader.message_type)
        if explanation is not None:
            newcomer.type_conflicts.append(explanation)
            return _refuse_type(writer, reader, explanation)
        policy_kind = mismatch(writer.qos, reader.qos)
        if policy_kind is not None:
            return _refuse_qos(writer, reader, policy_kind)
        writer.connect(reader)
        writer.matched.joined()
        reader.matched.joined()
        return [writer.matched, reader.matched, reader.liveliness_changed]

    def _part(self, writer: Writer, reader: Reader, *, stays: Endpoint) -> list[ReadySource]:
        writer.disconnect(reader)
        stays.matched.left()  # an endpoint is not notified of its own end
        return [stays.matched, reader.liveliness_changed]


def _refuse_type(writer: Writer, reader: Reader, explanation: str) -> list[ReadySource]:
    watching = observer.current()
    if watching is not None:
        watching.incompatible_type(writer.topic, explanation)
    writer.incompatible_type.add()
    reader.incompatible_type.add()
    return [writer.incompatible_type, reader.incompatible_type]


def _refuse_qos(writer: Writer, reader: Reader, policy_kind: int) -> list[ReadySource]:
    watching = observer.current()
    if watching is not None:
        watching.incompatible_qos(writer.topic, policy_kind, writer.node.full_name, reader.node.full_name)
    writer.incompatible_qos.refuse(policy_kind)
    reader.incompatible_qos.refuse(policy_kind)
    return [writer.incompatible_qos, reader.incompatible_qos]
