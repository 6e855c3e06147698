"""A message as a tree of JSON, cut to a size that a page can show."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import islice
from typing import Any, Final

_MOST_ITEMS: Final = 64
"""The number of elements that are shown of a sequence."""
_LONGEST: Final = 1000  # characters of a text
_MOST: Final = 3000
"""The number of values in a tree."""

Tree = dict[str, Any]


def tree(message: Any) -> Tree:
    """The fields of a message by name. A sequence that is cut has `{"more": count}` as its last element."""
    return _Budget().message(message)


class _Budget:
    def __init__(self) -> None:
        self._left = _MOST

    def message(self, message: Any) -> Tree:
        names = type(message).get_fields_and_field_types()
        return {name: self._value(getattr(message, name)) for name in names}

    def _value(self, value: Any) -> Any:
        self._left -= 1
        if value is None or isinstance(value, bool | int):
            return _safe(value)
        if isinstance(value, float):
            return value if math.isfinite(value) else str(value)
        if isinstance(value, str):
            return value if len(value) <= _LONGEST else f"{value[:_LONGEST]}..."
        if hasattr(type(value), "get_fields_and_field_types"):
            return self.message(value) if self._left > 0 else "..."
        if isinstance(value, Iterable):
            return self._items(value)
        return self._scalar(value)

    def _items(self, value: Any) -> Any:
        count = len(value)
        shown = min(count, _MOST_ITEMS, max(self._left, 0))
        items = [self._value(each) for each in islice(iter(value), shown)]
        return items if shown == count else [*items, {"more": count - shown}]

    def _scalar(self, value: Any) -> Any:
        """One of numpy's."""
        plain = value.item() if hasattr(value, "item") else str(value)
        return self._value(plain) if isinstance(plain, bool | int | float | str) else str(plain)


def _safe(value: bool | int | None) -> Any:
    """JavaScript's numbers are exact up to 2**53; beyond that a text says more."""
    return value if value is None or isinstance(value, bool) or abs(value) <= 2**53 else str(value)
