"""Mistakes in the class of a message."""

from __future__ import annotations

from typing import Any


def wrong_class(value: object, expected: type[Any]) -> TypeError:
    """The error for a message of another class; upstream raises the same without a text."""
    given = "None" if value is None else type(value).__name__
    if isinstance(value, type):
        given = f"the class {value.__name__} itself"
    return TypeError(f"expected {expected.__name__}, got {given}")
