"""The base class of Acme's messages."""

from __future__ import annotations

from typing import Any


class AcmeMessage:
    """Adds a one-line summary to a message class."""

    __slots__ = ()  # messages have slots, and stay as small as they are

    def summary(self) -> str:
        """The fields on one line: numbers and texts as they are, lists by their length."""
        values: Any = self
        names = values.get_fields_and_field_types()
        return ", ".join(f"{name}={_short(getattr(self, name))}" for name in names if name != "header")


def _short(value: object) -> str:
    if isinstance(value, AcmeMessage):
        return f"({value.summary()})"
    if isinstance(value, str | int | float | bytes):
        return repr(value)
    return f"<{len(value)}>" if hasattr(value, "__len__") else type(value).__name__
