"""Readings of one moment, from topics that arrive one after another and may lose some."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from typing import Any, Generic, TypeVar

from ..data import SECOND

Reading = TypeVar("Reading")

_KEPT = 4
_LATE = 20_000_000  # ns by which the reading of one topic is merely late
_FAR_AHEAD = 1_000_000_000  # ns: sensors are never silent for so long


class Recent(Generic[Reading]):
    """The last few readings of a topic, by stamp [ns]."""

    def __init__(self) -> None:
        self._readings: dict[int, Reading] = {}
        self._leap: tuple[int, Reading] | None = None  # the last reading, if time would have leapt with it
        self.newest = -1

    def put(self, stamp: int, reading: Reading) -> bool:
        """Keep a reading; False if it is older than the newest, or far ahead of it.

        Then it is late, its stamp is wrong, or time has leapt: see `leapt`.
        """
        ahead = stamp - self.newest
        if ahead < 0 or (ahead > _FAR_AHEAD and self.newest >= 0):
            self._leap = stamp, reading
            return False
        self._leap = None
        self.newest = stamp
        self._readings[stamp] = reading
        if len(self._readings) > _KEPT:
            del self._readings[next(iter(self._readings))]
        return True

    @property
    def last(self) -> int:
        """The moment of the last reading, whether it was kept or not."""
        return self.newest if self._leap is None else self._leap[0]

    def leap(self) -> None:
        """Keep the reading with which time leaps, and forget all others."""
        if self._leap is not None:
            self.newest, reading = self._leap
            self._readings, self._leap = {self.newest: reading}, None

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
        """Keep a reading; if time has leapt, forget the others."""
        if self._readings and not 0 <= stamp - self._readings[-1][0] <= _FAR_AHEAD:
            self._readings.clear()
        self._readings.append((stamp, reading))

    def nearest(self, stamp: int, most: int) -> Reading | None:
        """The reading nearest to a moment; None if there is none within `most` [ns]."""
        best = min(self._readings, key=lambda kept: abs(kept[0] - stamp), default=None)
        return None if best is None or abs(best[0] - stamp) > most else best[1]


def leapt(*topics: Recent[Any]) -> bool:
    """Go where time has leapt if the last reading of each topic is of that moment; True if it has gone back.

    If topics disagree, a reading is late, has a wrong stamp, or belongs to another publisher. If only some of
    them leap, time is where the others are: the stamps of those were wrong.
    """
    if len({topic.last for topic in topics}) > 1:
        return False
    distances = [topic.last - topic.newest for topic in topics]
    back = all(distance < 0 for distance in distances)
    if back or all(abs(distance) > _LATE for distance in distances if distance):
        for topic in topics:
            topic.leap()
    return back


def misdated(name: str, stamp: int, topic: Recent[Any]) -> str:
    """Words for a reading that was not kept, with its stamp [ns]."""
    seconds = (stamp - topic.newest) / SECOND
    return f"{name} is {abs(seconds):.3f} s {'newer' if seconds > 0 else 'older'} than the one before"


def newest_of_all(first: Recent[Any], *others: Recent[Any], after: int = -1) -> int | None:
    """The newest moment after another one for which every topic has a reading."""
    for stamp in first.since(after):
        for other in others:
            if not other.has(stamp):
                break
        else:
            return stamp
    return None
