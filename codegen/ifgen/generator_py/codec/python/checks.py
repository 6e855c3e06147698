"""The checks of values that keep to the fast path."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ifgen.definition.types import BasicTypeName
from ifgen.generator_py.codec.program import Value
from ifgen.generator_py.codec.python.code import slot_text


class ClassCheck(NamedTuple):
    """Whether a value is exactly of a class."""

    value: str
    class_name: str

    @property
    def fails(self) -> str:
        """The condition for another class."""
        return f"{self.value}.__class__ is not {self.class_name}"

    @property
    def holds(self) -> str:
        """The condition for this class."""
        return f"{self.value}.__class__ is {self.class_name}"


_CLASSES: dict[BasicTypeName, str] = {"boolean": "bool", "float": "float", "double": "float"}


def checked_value(value: Value, name: Callable[[str], str]) -> tuple[list[ClassCheck], str]:
    """The checks of a basic value, and the value to pack. `struct` itself checks integers and octets."""
    slot = slot_text(value.slot)
    if value.type == "char":
        return [], f'{slot}.encode("latin-1")'
    if value.type not in _CLASSES:
        return [], slot
    variable = name("x")
    return [ClassCheck(f"({variable} := {slot})", _CLASSES[value.type])], variable
