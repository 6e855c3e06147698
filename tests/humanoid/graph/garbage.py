"""Garbage for any type of message: what a broken driver, a wrong configuration or a bad neighbour publishes."""

from __future__ import annotations

import copy
import math
import random
import re
import time
from array import array
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

from humanoid.data import SECOND

_ARRAY = re.compile(r"(?:sequence<(?P<of>.+?)(?:, (?P<most>\d+))?>|(?P<item>.+)\[(?P<size>\d+)\])$")
_INTEGER = re.compile(r"(u?)int(\d+)$")
_FLOATS = {
    "float": [math.nan, math.inf, -math.inf, 3e38, -1e9],
    "double": [math.nan, math.inf, -math.inf, 1e300, -1e9],
}
_WORDS = ["", "nobody", "\x1b[31mred\x1b]0;title\x07\x1b[2J", "no\nline", "é" * 50, "map"]
_SMALL = {"float": 0.1, "double": 0.1}
_BYTES = {"byte": 8, "char": 8, "octet": 8}

Change = Callable[["Draw", str, Any], Any]


class Draw:
    """Draws messages from a seed."""

    def __init__(self, seed: str) -> None:
        self.random = random.Random(seed)

    def messages(self, kind: type[Any], good: Any | None, now: int) -> Iterator[tuple[str, Any]]:
        """Garbage of each sort, by its name; `good` is a message that the topic had, `now` its time [ns]."""
        yield "empty", kind()
        base = kind() if good is None else good
        for sort, change in _SORTS.items():
            yield sort, self.changed(base, change)
        for number in (0, 1, -1, 1_000, 86_400):
            yield f"stamp {number:+} s", self.stamped(base, now + number * SECOND)
        yield "the wall clock's stamp", self.stamped(base, time.time_ns())
        yield "a negative stamp", self.stamped(base, -5 * SECOND)
        for number in range(3):
            yield f"at random {number}", self.any_of(kind)

    def changed(self, message: Any, change: Change) -> Any:
        """A copy of a message, each of its values changed."""
        made = copy.deepcopy(message)
        for name, type_name in type(made).get_fields_and_field_types().items():
            setattr(made, name, self._changed(type_name, getattr(made, name), change))
        return made

    def _changed(self, type_name: str, value: Any, change: Change) -> Any:
        if hasattr(value, "get_fields_and_field_types"):
            return value if _is_time(type_name) else self.changed(value, change)
        found = _ARRAY.match(type_name)
        if found is None or change is _other_lengths:
            return change(self, type_name, value)
        return [self._changed(found["of"] or found["item"], item, change) for item in value]

    def stamped(self, message: Any, stamp: int) -> Any:
        """A copy with another stamp wherever it has one."""
        made = copy.deepcopy(message)
        for name, type_name in type(made).get_fields_and_field_types().items():
            value = getattr(made, name)
            if type_name == "builtin_interfaces/Time":
                value.sec = max(min(stamp // SECOND, 2**31 - 1), -(2**31))
                value.nanosec = stamp % SECOND
            elif hasattr(value, "get_fields_and_field_types"):
                setattr(made, name, self.stamped(value, stamp))
            elif isinstance(value, list):
                deep = [
                    self.stamped(v, stamp) if hasattr(v, "get_fields_and_field_types") else v for v in value
                ]
                setattr(made, name, deep)
        return made

    def any_of(self, kind: type[Any]) -> Any:
        """A message at random."""
        made = kind()
        for name, type_name in kind.get_fields_and_field_types().items():
            setattr(made, name, self.any(type_name))
        return made

    def any(self, type_name: str) -> Any:
        """A value at random."""
        if found := _ARRAY.match(type_name):
            most = min(int(found["most"] or 5), 5)
            size = int(found["size"]) if found["size"] else self.random.randint(0, most)
            return [self.any(found["of"] or found["item"]) for _ in range(size)]
        if type_name == "boolean":
            return self.random.random() < 0.5
        if type_name in _FLOATS:
            return self.random.choice([*_FLOATS[type_name], _SMALL[type_name], 0.0])
        if type_name in _BYTES:
            return bytes([self.random.randrange(256)]) if type_name == "octet" else self.random.randrange(256)
        if found := _INTEGER.match(type_name):
            return self.random.choice([*_limits(type_name), 0, 1])
        if type_name.startswith(("string", "wstring")):
            return _fitting(type_name, self.random.choice(_WORDS))
        package, _, name = type_name.partition("/")
        return self.any_of(getattr(import_module(f"{package}.msg"), name))


def _is_time(type_name: str) -> bool:
    return type_name == "builtin_interfaces/Time"


def _limits(type_name: str) -> tuple[int, int]:
    found = _INTEGER.match(type_name)
    assert found is not None
    bits = int(found[2])
    return (0, 2**bits - 1) if found[1] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _fitting(type_name: str, words: str) -> str:
    most = re.search(r"<(\d+)>", type_name)
    return words.encode()[: int(most[1])].decode(errors="ignore") if most else words


def _no_numbers(draw: Draw, type_name: str, value: Any) -> Any:
    return draw.random.choice(_FLOATS[type_name][:3]) if type_name in _FLOATS else value


def _one_no_number(draw: Draw, type_name: str, value: Any) -> Any:
    return math.nan if type_name in _FLOATS and draw.random.random() < 0.1 else value


def _huge(draw: Draw, type_name: str, value: Any) -> Any:
    return draw.random.choice(_FLOATS[type_name][3:]) if type_name in _FLOATS else value


def _outermost(draw: Draw, type_name: str, value: Any) -> Any:
    return draw.random.choice(_limits(type_name)) if _INTEGER.match(type_name) else value


def _largest(draw: Draw, type_name: str, value: Any) -> Any:
    return _limits(type_name)[1] if _INTEGER.match(type_name) else value


def _other_words(draw: Draw, type_name: str, value: Any) -> Any:
    if not type_name.startswith("string"):
        return value
    return _fitting(type_name, draw.random.choice(_WORDS))


def _escapes(draw: Draw, type_name: str, value: Any) -> Any:
    return _fitting(type_name, _WORDS[2]) if type_name.startswith("string") else value


def _other_lengths(draw: Draw, type_name: str, value: Any) -> Any:
    found = _ARRAY.match(type_name)
    if found is None or found["size"]:
        return value
    items = value.tolist() if isinstance(value, array) else list(value)
    longer = [draw.any(found["of"])]
    choice = draw.random.choice([items[:1], items[:-1], items + longer, longer, []])
    return choice[: int(found["most"] or len(choice))]


_SORTS: dict[str, Change] = {
    "no numbers": _no_numbers,
    "one that is no number": _one_no_number,
    "huge numbers": _huge,
    "integers at their limits": _outermost,
    "the largest integers": _largest,
    "other words": _other_words,
    "escapes": _escapes,
    "other lengths": _other_lengths,
    "other lengths again": _other_lengths,
}
