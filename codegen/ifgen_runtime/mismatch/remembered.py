"""Memory of nodes that come and go: bounded, and the oldest goes first."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Hashable
from typing import Final, Generic, TypeVar

ValueT = TypeVar("ValueT")

_MOST: Final = 4096


class Remembered(Generic[ValueT]):
    """Values by keys, for any thread. What nobody has asked for longest is forgotten."""

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._values: OrderedDict[Hashable, ValueT] = OrderedDict()
        self._lock = threading.Lock()

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


class Once:
    """Says of each key once that it is new."""

    def __init__(self) -> None:
        self._keys: Remembered[bool] = Remembered()

    def is_new(self, key: Hashable) -> bool:
        """Whether the key was not there; it is from now on."""
        if self._keys.get(key):
            return False
        self._keys.set(key, True)
        return True
