"""Copies and texts of messages: what the straight-line methods of generated classes call for each field."""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes longer to import than this module
if TYPE_CHECKING:
    from array import array
    from typing import Any


def copied_other(value: Any, memo: dict[int, Any]) -> Any:
    """A deep copy of anything."""
    from copy import deepcopy  # most copies never come here

    return deepcopy(value, memo)


def copied_object(value: Any, memo: dict[int, Any]) -> Any:
    """A deep copy of a message, an array.array or a numpy array, or of what a field holds in its place."""
    copied = memo.get(id(value))
    if copied is None:
        try:
            copy = value.__deepcopy__
        except AttributeError:
            return copied_other(value, memo)
        memo[id(value)] = copied = copy(memo)
    return copied


def copied_list(value: Any, memo: dict[int, Any]) -> Any:
    """A deep copy of a list, or of what a field for a list holds in its place."""
    if value.__class__ is not list:
        return copied_other(value, memo)
    copied = memo.get(id(value))
    if copied is None:
        memo[id(value)] = copied = []
        copied += [
            element if element.__class__ in _IMMUTABLE else copied_object(element, memo) for element in value
        ]
    return copied


_IMMUTABLE = frozenset({str, bytes, bool})


def repr_name(message: Any) -> str:
    """A class as the repr of its objects shows it: `geometry_msgs.msg.Pose`."""
    cls = message.__class__
    package, dot, _ = cls.__module__.rpartition(".")
    return f"{package}{dot}{cls.__name__}"


def array_repr(values: array[Any]) -> str:
    """The elements of an array.array as the repr of a message shows them: `[1.0, 2.0]`."""
    return repr(values)[len("array('X', ") : -1] if len(values) else "[]"
