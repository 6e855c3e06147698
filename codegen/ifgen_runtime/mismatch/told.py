"""Limits on what is said about definitions that differ: nodes may come and go by the thousand."""

from __future__ import annotations

import _thread
from enum import Enum, auto
from typing import Final

PAIRS: Final = 10
"""The warnings about one topic, service or action."""

NAMES: Final = 256
"""The topics, services and actions that are counted one by one."""


class Say(Enum):
    """The words for one more pair of endpoints."""

    ALL = auto()
    NO_MORE = auto()
    """This once: that no more is said about this name."""
    NOTHING = auto()


class Told:
    """Counts the warnings for each name, for as long as a context lives."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def count(self, name: str) -> Say:
        """Count one more pair of endpoints on a name; names beyond the limit share one count."""
        with self._lock:
            if len(self._counts) >= NAMES and name not in self._counts:
                name = ""
            count = self._counts[name] = self._counts.get(name, 0) + 1
        if count <= PAIRS:
            return Say.ALL
        return Say.NO_MORE if count == PAIRS + 1 else Say.NOTHING
