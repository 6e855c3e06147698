"""Says in which fields two messages differ: of their long texts pytest shows only both ends."""

from __future__ import annotations

import array
import reprlib
from collections.abc import Iterator
from itertools import islice
from typing import Any

_SHOWN = 100  # lines, with -vv; without it pytest itself shows eight
_SEQUENCES = (list, tuple, array.array)


def explain(left: object, right: object) -> list[str] | None:
    """The lines that pytest prints of `assert left == right` for messages, lists of them and replays."""
    if not _has_messages(left) or type(left) is not type(right):
        return _of_two_classes(left, right)
    found = list(islice(differences("", left, right), _SHOWN + 1))
    if not found:
        return None
    lines = found if len(found) <= _SHOWN else [*found[:_SHOWN], "..."]
    return [f"{_named(left)} == {_named(right)}", *lines]


def _of_two_classes(left: object, right: object) -> list[str] | None:
    """The lines for messages of one type whose classes differ: never equal, though they look alike."""
    if not (_is_message(left) and _is_message(right)) or _type_name(left) != _type_name(right):
        return None
    hashes = [getattr(type(each), "__type_hash__", "unknown") for each in (left, right)]
    why = "of one definition" if hashes[0] == hashes[1] else f"of the definitions {' and '.join(hashes)}"
    return [f"{_named(left)} == {_named(right)}", f"these are two classes of {_type_name(left)}, {why}"]


def _type_name(message: object) -> str:
    cls = type(message)
    return f"{cls.__module__.partition('.')[0]}/{cls.__name__}"


def differences(path: str, left: Any, right: Any) -> Iterator[str]:
    """The fields in which two messages differ, or lists of them: `pose.position.y: 0.2 != 0.3`."""
    if _is_replay(left):
        yield from left.differences(right)
    elif _is_message(left) and type(left) is type(right):
        for field in left.get_fields_and_field_types():
            yield from differences(f"{path}.{field}", _value(left, field), _value(right, field))
    elif _is_sequence(left) and _is_sequence(right):
        if len(left) != len(right):
            counts = [counted(len(each), "element") for each in (left, right)]
            yield f"{path or 'in all'}: {' != '.join(counts)}".lstrip(".")
        for index, pair in enumerate(zip(left, right, strict=False)):
            yield from differences(f"{path}[{index}]", *pair)
    elif left != right:
        yield f"{path}: {reprlib.repr(left)} != {reprlib.repr(right)}".lstrip(".")


def _value(message: Any, field: str) -> Any:
    """A field's value; where its name is a keyword of Python, the attribute ends with an underscore."""
    return getattr(message, field) if hasattr(message, field) else getattr(message, f"{field}_")


def _is_replay(value: object) -> bool:
    return type(value).__module__ == "ifgen_pytest.replaying"  # without importing what few tests need


def _is_message(value: object) -> bool:
    return hasattr(type(value), "get_fields_and_field_types")


def _is_sequence(value: object) -> bool:
    # Arrays of numpy, without importing it.
    return isinstance(value, _SEQUENCES) or (hasattr(value, "tolist") and getattr(value, "ndim", 0) == 1)


def _has_messages(value: object) -> bool:
    return (
        _is_message(value)
        or _is_replay(value)
        or (isinstance(value, (list, tuple)) and any(map(_is_message, value)))
    )


def counted(count: int, noun: str) -> str:
    """`1 message`, `2 messages`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _named(value: Any) -> str:
    """The classes of what is compared, the first three of a sequence."""
    if not isinstance(value, (list, tuple)):
        return type(value).__name__
    return f"[{', '.join(map(_named, value[:3]))}{', ...' if len(value) > 3 else ''}]"
