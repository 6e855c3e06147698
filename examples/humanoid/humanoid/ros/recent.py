"""Readings of one moment, from topics that arrive one after another and may lose some."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from typing import Any, Generic, TypeVar

Reading = TypeVar("Reading")

_KEPT = 4


class Recent(Generic[Reading]):
    """The last few readings of a topic, by stamp [ns]."""

    def __init__(self) -> None:
        self._readings: dict[int, Reading] = {}
        self._older: tuple[int, Reading] | None = None  # the last reading, if it was older than the newest
        self.newest = -1

    def put(self, stamp: int, reading: Reading) -> bool:
        """Keep a reading; False if it is older than the newest: it is late, or time has gone back."""
        if stamp < self.newest:
            self._older = stamp, reading
            return False
        self._older = None
        self.newest = stamp
        self._readings[stamp] = reading
        if len(self._readings) > _KEPT:
            del self._readings[next(iter(self._readings))]
        return True

    @property
    def older(self) -> int | None:
        """The moment of the last reading, if it was older than the newest."""
        return None if self._older is None else self._older[0]

    def rewind(self) -> None:
        """Forget everything except the older reading that arrived last."""
        assert self._older is not None
        self.newest, reading = self._older
        self._readings, self._older = {self.newest: reading}, None

    def at(self, stamp: int) -> Reading:
        """The reading of a moment. Raises KeyError if it is not among the last few."""
        return self._readings[stamp]

    def at_or_last(self, stamp: int) -> Reading | None:
        """The reading of a moment, or otherwise the newest; None if there never was one."""
        return self._readings.get(stamp, self._readings.get(self.newest))

    def has(self, stamp: int) -> bool:
        """Whether the reading of a moment is among the last few."""
        return stamp in self._readings

    def count_since(self, stamp: int) -> int:
        """How many of the last few readings are newer than a moment."""
        return sum(one > stamp for one in self._readings) if self.newest > stamp else 0

    def since(self, stamp: int) -> Iterator[int]:
        """The moments of the readings after another one, newest first."""
        return itertools.takewhile(stamp.__lt__, reversed(self._readings))


class History(Generic[Reading]):
    """The readings of a topic for a while, by stamp [ns], for what arrives later than they do."""

    def __init__(self, count: int) -> None:
        """Keep this many readings."""
        self._readings: deque[tuple[int, Reading]] = deque(maxlen=count)

    def __len__(self) -> int:
        """How many readings there are."""
        return len(self._readings)

    def put(self, stamp: int, reading: Reading) -> None:
        """Keep a reading; if time has gone back, forget the others."""
        if self._readings and stamp < self._readings[-1][0]:
            self._readings.clear()
        self._readings.append((stamp, reading))

    def nearest(self, stamp: int, most: int) -> Reading | None:
        """The reading nearest to a moment; None if there is none within `most` [ns]."""
        best = min(self._readings, key=lambda kept: abs(kept[0] - stamp), default=None)
        return None if best is None or abs(best[0] - stamp) > most else best[1]


def rewound(*topics: Recent[Any]) -> bool:
    """Whether time has gone back; all topics must say so, and then earlier readings are forgotten.

    If only one of them says so, its reading is late or belongs to another publisher.
    """
    moments = {topic.older for topic in topics}
    if None in moments or len(moments) > 1:
        return False
    for topic in topics:
        topic.rewind()
    return True


def newest_of_all(first: Recent[Any], *others: Recent[Any], after: int = -1) -> int | None:
    """The newest moment after another one for which every topic has a reading."""
    for stamp in first.since(after):
        for other in others:
            if not other.has(stamp):
                break
        else:
            return stamp
    return None
