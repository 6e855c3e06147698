"""Mistakes in the class of a message, and texts that a message cannot hold."""

from __future__ import annotations

import re
from types import CoroutineType
from typing import Any, Final, TypeVar

_LONE_SURROGATE: Final = re.compile("[\ud800-\udfff]")
_T = TypeVar("_T")


def cleaned_text(text: str) -> str:
    """A text that every message can hold.

    It ends before a NUL, as upstream's does. Half of a surrogate pair becomes U+FFFD.
    """
    text = text.partition("\0")[0] if "\0" in text else text
    return text if text.isascii() else _LONE_SURROGATE.sub("\ufffd", text)


def cleaned(message: _T) -> _T:
    """A copy of a message of rclpy's own, with texts of programs in it that it can hold.

    Programs do not send it, so it must not fail because of them.
    """
    kind: Any = type(message)
    fields = kind.get_fields_and_field_types()
    copy: _T = kind(**{name: _cleaned_value(getattr(message, name)) for name in fields})
    return copy


def _cleaned_value(value: Any) -> Any:
    if isinstance(value, str):
        return cleaned_text(value)
    if isinstance(value, list):
        return [_cleaned_value(each) for each in value]
    return cleaned(value) if hasattr(value, "get_fields_and_field_types") else value


def wrong_class(value: object, expected: type[Any]) -> TypeError:
    """The error for a message of another class; upstream raises the same without a text."""
    return TypeError(f"expected {expected.__name__}, got {described(value)}")


def described(value: object) -> str:
    """Name a value of another class than was expected."""
    if isinstance(value, type):
        return f"the class {value.__name__} itself"
    return "None" if value is None else type(value).__name__


def wrong_return(callback: str, value: object, expected: type[Any]) -> str:
    """Say that a callback, as the sentence names it, has returned something of another class.

    A coroutine is closed: nobody would await it.
    """
    if isinstance(value, CoroutineType):
        value.close()
        return f"{callback} returned a coroutine, expected {expected.__name__}: nobody awaits it there"
    hint = ": is a `return` missing?" if value is None else ""
    return f"{callback} returned {described(value)}, expected {expected.__name__}{hint}"
