"""Mistakes in the class of a message."""

from __future__ import annotations

from types import CoroutineType
from typing import Any


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
