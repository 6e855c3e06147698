"""The messages of one topic, as values and as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ifgen_runtime.bag.errors import need
from ifgen_runtime.bag.store import Store
from ifgen_runtime.bag.topics import Recorded, Wanted

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
