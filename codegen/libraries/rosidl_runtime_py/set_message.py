# Messages and values of users are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Values for the fields of messages."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rosidl_runtime_py.convert import get_message_slot_types
from rosidl_runtime_py.import_message import import_message_from_namespaced_type

__all__ = ["set_message_fields"]

Setter = Callable[[Any], None]


def set_message_fields(
    msg: Any,
    values: Mapping[str, Any],
    expand_header_auto: bool = False,
    expand_time_now: bool = False,
) -> list[Setter]:
    """Set fields of a message, also within messages, and return functions that set times.

    With `expand_header_auto` a header can be `auto`, with `expand_time_now` a time can be `now`: for each the
    list has a function, which takes the time of sending. Raises AttributeError for a field that the message
    does not have, TypeError and ValueError for a value that it cannot have.
    """
    setters: list[Setter] = []
    words: dict[tuple[str, str], str] = {}
    if expand_header_auto:
        words["std_msgs", "Header"] = "auto"
    if expand_time_now:
        words["builtin_interfaces", "Time"] = "now"
    _fill(msg, values, words, setters)
    return setters


def _fill(msg: Any, values: Any, words: Mapping[tuple[str, str], str], setters: list[Setter]) -> None:
    if not isinstance(values, Mapping):
        raise TypeError(f"expected a dict of fields, got the {type(values).__name__} {values!r}")
    types = get_message_slot_types(msg)
    for name, given in values.items():
        before = getattr(msg, name)
        kind = type(before)
        key = (kind.__module__.partition(".")[0], kind.__name__)
        if isinstance(given, str) and words.get(key) == given:
            owner, attribute = (before, "stamp") if given == "auto" else (msg, name)
            setters.append(partial(setattr, owner, attribute))
            continue
        value = _value(before, given, words, setters)
        element = getattr(types.get(name), "value_type", None)
        if element is not None and hasattr(element, "namespaced_name"):
            value = [
                _message(import_message_from_namespaced_type(element), each, words, setters) for each in value
            ]
        setattr(msg, name, value)


def _value(before: Any, given: Any, words: Mapping[tuple[str, str], str], setters: list[Setter]) -> Any:
    """Return a value of the type that a field has now."""
    kind = type(before)
    if isinstance(before, array):
        return array(before.typecode, given)
    if kind.__name__ == "ndarray":
        import numpy as np  # there is an array of it

        return np.array(given, dtype=before.dtype)
    if type(given) is kind:
        return given
    if hasattr(before, "get_fields_and_field_types"):
        return _message(kind, given, words, setters)
    return kind(given)


def _message(kind: Any, given: Any, words: Mapping[tuple[str, str], str], setters: list[Setter]) -> Any:
    if isinstance(given, kind):
        return given
    message = kind()
    _fill(message, given, words, setters)
    return message
