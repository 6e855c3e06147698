"""Limits on what is remembered, and said, of nodes that come and go by the thousand."""

from __future__ import annotations

import _thread
from collections import OrderedDict
from collections.abc import Hashable
from enum import Enum, auto
from typing import Final, Generic, TypeVar

ValueT = TypeVar("ValueT")

WARNINGS: Final = 10
"""The warnings about one topic, service or action."""

NAMES: Final = 256
"""The topics, services and actions whose warnings are counted one by one."""

_MOST: Final = 4096


class Lru(Generic[ValueT]):
    """Values by keys, for any thread. What nobody has asked for longest is forgotten."""

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, ValueT] = OrderedDict()
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def get(self, key: Hashable) -> ValueT | None:
        """The value of a key; None if there is none, or no longer."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def set(self, key: Hashable, value: ValueT) -> None:
        """Keep a value."""
        with self._lock:
            self._values[key] = value
            self._values.move_to_end(key)
            if len(self._values) > self._most:
                self._values.popitem(last=False)

    def pop(self, key: Hashable) -> ValueT | None:
        """Forget the value of a key, and return it."""
        with self._lock:
            return self._values.pop(key, None)


class SeenSet:
    """Keys that have been seen, for one thread."""

    def __init__(self) -> None:
        self._keys: Lru[bool] = Lru()

    def add(self, key: Hashable) -> bool:
        """Add a key; returns whether it is new."""
        is_new = self._keys.get(key) is None
        self._keys.set(key, True)
        return is_new


class Say(Enum):
    """The words for one more pair of endpoints."""

    ALL = auto()
    NO_MORE = auto()
    """This once: that no more is said about this name."""
    NOTHING = auto()


class WarningLimit:
    """Counts the warnings about each name, for as long as a context lives."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._lock = _thread.allocate_lock()  # as above

    def count(self, name: str) -> Say:
        """Count one more pair of endpoints on a name; names beyond the limit share one count."""
        with self._lock:
            if len(self._counts) >= NAMES and name not in self._counts:
                name = ""
            count = self._counts[name] = self._counts.get(name, 0) + 1
        if count <= WARNINGS:
            return Say.ALL
        return Say.NO_MORE if count == WARNINGS + 1 else Say.NOTHING
