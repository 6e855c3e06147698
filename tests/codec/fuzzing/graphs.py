"""Any object with all that it refers to, in a form that can be compared: for copies, which may hold anything."""

from __future__ import annotations

from array import array
from typing import Any

import numpy
from ifgen_runtime.field_types import fields_of


def graph(value: Any, original: set[int] | None = None) -> Any:
    """The value down to types, bits and what is there twice; marks what it shares with an original."""
    return _graph(value, {}, original or set())


def identities(value: Any) -> set[int]:
    """The objects in a value that can change."""
    seen: dict[int, int] = {}
    _graph(value, seen, set())
    return set(seen)


def _graph(value: Any, seen: dict[int, int], original: set[int]) -> Any:
    kind = type(value)
    if kind in (bool, int, str, bytes, type(None)):
        return kind.__name__, value
    if issubclass(kind, float):
        return kind.__name__, float.hex(float(value))
    if id(value) in seen:
        return "again", seen[id(value)]
    if kind is tuple:
        return "tuple", [_graph(each, seen, original) for each in value]
    if (
        kind is not list
        and kind is not array
        and not isinstance(value, numpy.ndarray)
        and not _is_message(kind)
    ):
        return kind.__name__, repr(value)
    seen[id(value)] = len(seen)
    shared = id(value) in original
    if kind is list:
        return "list", shared, [_graph(each, seen, original) for each in value]
    if kind is array:
        return "array", shared, value.typecode, value.tobytes()
    if _is_message(kind):
        return (
            kind.__name__,
            id(kind),
            shared,
            [_slot(value, f.slot, seen, original) for f in fields_of(kind)],
        )
    return "numpy", shared, value.dtype.str, value.shape, value.flags.writeable, repr(value.tolist())


def _is_message(kind: type[Any]) -> bool:
    return hasattr(kind, "_fields_and_field_types")


def _slot(message: Any, slot: str, seen: dict[int, int], original: set[int]) -> Any:
    try:
        value = getattr(message, slot)
    except AttributeError:
        return "empty"
    return _graph(value, seen, original)
