"""Recordings, as `Bag` shows them, and the messages of one topic, as values and as arrays."""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from ifgen_runtime.bag.errors import BagError, Damage, Damages, need
from ifgen_runtime.bag.store import Store
from ifgen_runtime.bag.topics import Channel, Recorded, Topic, Wanted

if TYPE_CHECKING:
    from ifgen_runtime.bag.columns import Array


class Messages:
    """The messages of one topic of a bag, in the order in which they were received."""

    def __init__(self, store: Store, wanted: Wanted, topic: str) -> None:
        self._store = store
        self._wanted = wanted
        self.topic = store.topics[topic]
        """The topic."""

    @property
    def message_class(self) -> type[Any]:
        """The class of the messages. Raises BagError if there is none."""
        return self._store.class_of(self.topic.name)

    def __len__(self) -> int:
        """The number of messages: what the files say, or counted where only a part of the time is wanted."""
        if self._wanted.start is None and self._wanted.end is None:
            return self.topic.count
        return sum(map(len, self._store.batches(self._wanted)))

    def __bool__(self) -> bool:
        return True

    def __iter__(self) -> Iterator[Any]:
        """The messages. One that cannot be read is left out with a BagWarning; a strict bag raises."""
        return self._store.messages(self._wanted)

    def recorded(self) -> Iterator[Recorded]:
        """The messages with their times."""
        return self._store.recorded(self._wanted)

    def between(self, start: int | None = None, end: int | None = None) -> Messages:
        """Those that were received in [start, end) [ns since 1970]."""
        return Messages(self._store, Wanted(self._wanted.topics, start, end), self.topic.name)

    def received(self) -> Array:
        """When each message was received [ns since 1970]: int64 of shape (n,)."""
        return self._times("received")

    def published(self) -> Array:
        """When each message was published [ns since 1970]: int64 of shape (n,)."""
        return self._times("published")

    def _times(self, which: str) -> Array:
        import numpy as np  # takes long to load, and a program may not need it

        batches = self._store.batches(self._wanted)
        blocks = [np.array(getattr(batch, which), np.uint64).astype(np.int64) for batch in batches]
        return np.concatenate(blocks) if blocks else np.empty(0, np.int64)

    def column(self, path: str, *, ragged: bool = False) -> Array:
        """A field of all messages as a numpy array: `pose.position.x` of shape (n,), `position` of (n, m).

        A time or a duration, such as `header.stamp`, is int64 [ns]. Texts are objects. Sequences of numbers
        need the same size in all messages; with `ragged` they become an array of arrays. Raises BagError.
        """
        return self.columns(path, ragged=ragged)[path]

    def columns(self, *paths: str, ragged: bool = False) -> dict[str, Array]:
        """Several fields, read at once."""
        return self._columns(paths, ragged, [])

    def _columns(self, paths: Sequence[str], ragged: bool, times: list[int]) -> dict[str, Array]:
        """Several fields; appends to `times` when their messages were received."""
        from ifgen_runtime.bag.columns import Column  # with numpy, which a program may not need

        builders = {path: Column(self.message_class, path).builder(ragged) for path in paths}
        for received, message in self._store.messages_with_times(self._wanted):
            times.append(received)
            for builder in builders.values():
                builder.add(message)
        return {path: builder.array() for path, builder in builders.items()}

    def frame(self, *paths: str) -> Any:
        """Fields of all messages as a table of pandas, by the times at which they were received.

        Without `paths`, all fields that are single values. Sequences are arrays in cells.
        """
        from ifgen_runtime.bag.columns import leaves  # with numpy, which a program may not need

        pandas: Any = need("pandas", "a table of messages")
        received: list[int] = []
        columns = self._columns(paths or tuple(leaves(self.message_class)), True, received)
        index = pandas.to_datetime(received, unit="ns", utc=True)
        cells = {path: list(values) if values.ndim > 1 else values for path, values in columns.items()}
        return pandas.DataFrame(cells, index=index.rename("received"))

    def __repr__(self) -> str:
        return f"<messages of {self.topic.name}, {self.topic.type_name}>"


class Bag:
    """A recording: a `.mcap` or `.db3` file, or a folder of them as `ros2 bag record` makes it.

    `path` is never changed. With `strict`, damage raises BagError; otherwise all that can be read is, and a
    BagWarning says what cannot. With `views`, sequences of numbers are numpy arrays that show the bytes of
    their message, as with `deserialize(..., views=True)`: images are read with one copy less. `classes` are
    the classes to use, by type name, in place of those that would be found.

    A small file that unpacks to very much is read up to a limit, unless `unlimited` says that you trust it.

    Close a bag, or use it in a `with` statement; what is forgotten is closed, too.
    """

    def __init__(
        self,
        path: str | PathLike[str],
        *,
        strict: bool = False,
        views: bool = False,
        unlimited: bool = False,
        classes: Mapping[str, type[Any]] | None = None,
    ) -> None:
        self.path = Path(path)
        """The file or folder."""
        self._store = Store(self.path, Damages(strict, unlimited), classes or {}, views)
        # Whoever iterates has the store, and perhaps no bag any more.
        self._close = weakref.finalize(self._store, self._store.recording.close)
        self.topics: Mapping[str, Topic] = self._store.topics
        """The topics by name, in the order of their names."""
        sources = self._store.recording.sources
        self.start: int | None = min((s.start for s in sources if s.start is not None), default=None)
        """When the first message was received [ns since 1970]; None if there are no messages."""
        self.end: int | None = max((s.end for s in sources if s.end is not None), default=None)
        """When the last message was received [ns since 1970]."""

    @property
    def files(self) -> tuple[Path, ...]:
        """The files of the recording, in the order in which its metadata names them."""
        return tuple(self._store.recording.files)

    @property
    def ros_distro(self) -> str:
        """The distribution of ROS that the metadata names; empty if it names none."""
        return self._store.recording.ros_distro

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels: one for each topic and definition in each file."""
        return tuple(channel for source in self._store.recording.sources for channel in source.channels)

    @property
    def attachments(self) -> int:
        """The attachments of MCAP files. Nothing here reads them but their checksums."""
        return sum(source.attachments for source in self._store.recording.sources)

    @property
    def damage(self) -> tuple[Damage, ...]:
        """The damage that was met so far."""
        return self._store.damages.found

    def __len__(self) -> int:
        """All messages, by what the files say about themselves."""
        return sum(topic.count for topic in self.topics.values())

    def __bool__(self) -> bool:
        return True

    def __iter__(self) -> Iterator[Recorded]:
        """All messages with their times, in the order in which they were received."""
        return self.recorded()

    def __contains__(self, topic: object) -> bool:
        return topic in self.topics

    def __getitem__(self, topic: str) -> Messages:
        """The messages of a topic. Raises BagError if there is no such topic."""
        self._require([topic])
        return Messages(self._store, Wanted(frozenset([topic])), topic)

    def recorded(self, *topics: str, start: int | None = None, end: int | None = None) -> Iterator[Recorded]:
        """The messages of these topics (of all, if none is named) that were received in [start, end) [ns]."""
        self._require(topics)
        return self._store.recorded(Wanted(frozenset(topics) or None, start, end))

    def entries(
        self, *topics: str, start: int | None = None, end: int | None = None
    ) -> Iterator[tuple[int, int, Channel, bytes]]:
        """The same messages without anything around them: received and published [ns], channel, bytes.

        Bytes are those that were published, also where each message was compressed by itself.
        """
        self._require(topics)
        return self._store.entries(Wanted(frozenset(topics) or None, start, end))

    def class_for(self, channel: Channel) -> type[Any]:
        """The class of a channel's messages. Raises BagError if there is none."""
        return self._store.class_for(channel)

    def class_of(self, topic: str) -> type[Any]:
        """The class of a topic's messages. Raises BagError if there is none, or if the topic has two."""
        self._require([topic])
        return self._store.class_of(topic)

    def _require(self, topics: tuple[str, ...] | list[str]) -> None:
        for topic in topics:
            if topic not in self.topics:
                near = get_close_matches(topic, self.topics, 3, 0.5) or list(self.topics)[:3]
                known = f"it has {', '.join(near)}" if near else "it has no topics"
                raise BagError(f"{self.path}: there is no topic {topic!r}: {known}")

    def close(self) -> None:
        """Close the files."""
        self._store.is_open = False
        self._close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Bag {str(self.path)!r}: {len(self)} messages of {len(self.topics)} topics>"
