"""Says in which fields two messages differ: of their long texts pytest shows only both ends."""

from __future__ import annotations

import array
import reprlib
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

_SHOWN = 100  # lines, with -vv; without it pytest itself shows eight
_SEQUENCES = (list, tuple, array.array)


def explain(left: object, right: object) -> list[str] | None:
    """The lines that pytest prints of `assert left == right` for messages, or lists of them; else None."""
    if not (_has_messages(left) and type(left) is type(right)):
        return None
    found = list(islice(_differences("", left, right), _SHOWN + 1))
    if not found:
        return None
    lines = found if len(found) <= _SHOWN else [*found[:_SHOWN], "..."]
    return [f"{_named(left)} == {_named(right)}", *lines]


def _differences(path: str, left: Any, right: Any) -> Iterator[str]:
    if _is_message(left) and type(left) is type(right):
        for field in left.get_fields_and_field_types():
            yield from _differences(f"{path}.{field}", _value(left, field), _value(right, field))
    elif _is_sequence(left) and _is_sequence(right):
        if len(left) != len(right):
            yield f"{path or 'in all'}: {_counted(left)} != {_counted(right)}".lstrip(".")
        for index, pair in enumerate(zip(left, right, strict=False)):
            yield from _differences(f"{path}[{index}]", *pair)
    elif left != right:
        yield f"{path}: {reprlib.repr(left)} != {reprlib.repr(right)}".lstrip(".")


def _value(message: Any, field: str) -> Any:
    """A field's value; where its name is a keyword of Python, the attribute ends with an underscore."""
    return getattr(message, field) if hasattr(message, field) else getattr(message, f"{field}_")


def _is_message(value: object) -> bool:
    return hasattr(type(value), "get_fields_and_field_types")


def _is_sequence(value: object) -> bool:
    # Arrays of numpy, without importing it.
    return isinstance(value, _SEQUENCES) or (hasattr(value, "tolist") and getattr(value, "ndim", 0) == 1)


def _has_messages(value: object) -> bool:
    return _is_message(value) or (isinstance(value, (list, tuple)) and any(map(_is_message, value)))


def _counted(values: Sequence[Any]) -> str:
    return f"{len(values)} element" if len(values) == 1 else f"{len(values)} elements"


def _named(value: Any) -> str:
    """The classes of what is compared, the first three of a sequence."""
    if not isinstance(value, (list, tuple)):
        return type(value).__name__
    return f"[{', '.join(map(_named, value[:3]))}{', ...' if len(value) > 3 else ''}]"
