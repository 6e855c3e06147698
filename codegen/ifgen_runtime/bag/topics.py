"""The contents of a recording: topics, the definitions of their types, and messages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Any, Protocol, Self, TypeAlias

from ifgen_runtime.bag.qos import OfferedQoS


@dataclass(frozen=True, slots=True)
class Definition:
    """The definition of a type as a file has it."""

    type_name: str
    """`pkg/msg/Name`."""
    type_hash: str = ""
    """`RIHS01_...`; empty in files from before ROS 2 Iron, and from other writers."""
    encoding: str = ""
    """`ros2msg` or `ros2idl`; empty if the file has no text."""
    text: str = ""
    """The text of the type and of all that it refers to."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of a recording."""

    name: str
    definitions: tuple[Definition, ...]
    """Those that its messages have. One, unless the type changed while it was recorded."""
    qos: tuple[OfferedQoS, ...]
    """The profiles that its publishers offered; empty if the file does not say."""
    count: int
    """Messages, by what the files say about themselves."""
    encoding: str = "cdr"
    """The serialisation of its messages."""

    @property
    def type_name(self) -> str:
        """`pkg/msg/Name`."""
        return self.definitions[0].type_name

    @property
    def type_hash(self) -> str:
        """`RIHS01_...`, or empty if the files do not say."""
        return self.definitions[0].type_hash


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """The messages of a topic with one definition, in one file."""

    topic: str
    definition: Definition
    qos: tuple[OfferedQoS, ...] = ()
    encoding: str = "cdr"


Entry: TypeAlias = tuple[int, int, Channel, bytes]
"""A message in a file: received and published [ns], its channel, its serialised form."""


class Batch:
    """Messages in columns, which cost the garbage collector nothing."""

    __slots__ = ("channels", "data", "published", "received")

    def __init__(self) -> None:
        self.received: list[int] = []
        self.published: list[int] = []
        self.channels: list[Channel] = []
        self.data: list[bytes] = []

    @classmethod
    def of(cls, entries: Iterable[Entry]) -> Self:
        """A batch of these messages."""
        batch = cls()
        for received, published, channel, data in entries:
            batch.received.append(received)
            batch.published.append(published)
            batch.channels.append(channel)
            batch.data.append(data)
        return batch

    def __len__(self) -> int:
        return len(self.data)

    def __iter__(self) -> Iterator[Entry]:
        return zip(self.received, self.published, self.channels, self.data, strict=True)

    def runs(self) -> Iterator[tuple[Channel, Iterator[bytes]]]:
        """The serialised forms, as many together as follow each other in a channel."""
        channels = self.channels
        if channels and channels.count(channels[0]) == len(channels):
            yield channels[0], iter(self.data)
            return
        for channel, run in groupby(zip(channels, self.data, strict=True), itemgetter(0)):
            yield channel, map(itemgetter(1), run)


@dataclass(frozen=True, slots=True)
class Wanted:
    """The messages that somebody asks for: of these topics (None: all), received in [start, end) [ns]."""

    topics: frozenset[str] | None = None
    start: int | None = None
    end: int | None = None

    def overlaps(self, first: int, last: int) -> bool:
        """Whether there may be some among those received from `first` to `last`, inclusive."""
        return (self.end is None or first < self.end) and (self.start is None or last >= self.start)

    def has_time(self, received: int) -> bool:
        """Whether one that was received then is in the range."""
        return (self.end is None or received < self.end) and (self.start is None or received >= self.start)

    def has_topic(self, topic: str) -> bool:
        """Whether messages of a topic are."""
        return self.topics is None or topic in self.topics


class Source(Protocol):
    """A file of messages."""

    channels: dict[Channel, int]
    """How many messages each has, by what the file says about itself."""
    start: int | None
    """When its first message was received [ns]; None if it has none."""
    end: int | None
    """When its last message was received [ns]."""
    attachments: int
    """Its attachments, which nothing here reads."""

    def batches(self, wanted: Wanted) -> Iterator[Batch]:
        """The messages in the order in which they were received, some at a time."""
        ...

    def close(self) -> None:
        """Close the file."""
        ...


class Recorded:
    """A message as it was recorded, with its times. `message` is made when it is first asked for."""

    __slots__ = ("_channel", "_decode", "_message", "data", "published", "received", "topic")

    topic: str
    received: int
    """When it was received [ns since 1970]: the time that the recording is ordered by."""
    published: int
    """When it was published [ns since 1970]; the same as `received` if the file does not say."""
    data: bytes
    """Its serialised form."""

    def __init__(self, entry: Entry, decode: Callable[[Channel, bytes], Any]) -> None:
        self.received, self.published, self._channel, self.data = entry
        self.topic = self._channel.topic
        self._decode = decode
        self._message: Any = None

    @property
    def message(self) -> Any:
        """The message, of the class that `Bag` found for it. Raises BagError if there is none."""
        if self._message is None:
            self._message = self._decode(self._channel, self.data)
        return self._message

    @property
    def definition(self) -> Definition:
        """The definition of its type."""
        return self._channel.definition

    @property
    def qos(self) -> tuple[OfferedQoS, ...]:
        """The profiles that publishers of its topic offered."""
        return self._channel.qos

    def __repr__(self) -> str:
        return (
            f"<{self.topic} {self.definition.type_name} received {self.received} ns, {len(self.data)} bytes>"
        )
