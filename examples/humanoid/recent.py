"""Readings of one moment, from topics that come one after the other and may lose some."""

from __future__ import annotations

from typing import Any, Generic, TypeVar

Reading = TypeVar("Reading")

_KEPT = 4


class Recent(Generic[Reading]):
    """The last few readings of a topic, by stamp [ns]."""

    def __init__(self) -> None:
        self._readings: dict[int, Reading] = {}
        self.newest = -1

    def put(self, stamp: int, reading: Reading) -> bool:
        """Keep a reading; False if time has gone back, and then what there was is forgotten."""
        went_on = stamp >= self.newest
        if not went_on:
            self._readings.clear()
        self.newest = stamp
        self._readings[stamp] = reading
        if len(self._readings) > _KEPT:
            del self._readings[next(iter(self._readings))]
        return went_on

    def at(self, stamp: int) -> Reading:
        """The reading of a moment. Raises KeyError if it is not among the last few."""
        return self._readings[stamp]

    def at_or_last(self, stamp: int) -> Reading | None:
        """The reading of a moment, or else the newest; None if there never was one."""
        return self._readings.get(stamp, self._readings.get(self.newest))

    def has(self, stamp: int) -> bool:
        """Whether the reading of a moment is among the last few."""
        return stamp in self._readings

    def stamps(self) -> list[int]:
        """Of which moments there are readings, the newest first."""
        return list(reversed(self._readings))


def newest_of_all(first: Recent[Any], *others: Recent[Any]) -> int | None:
    """The newest moment of which every topic has a reading."""
    return next((stamp for stamp in first.stamps() if all(other.has(stamp) for other in others)), None)
