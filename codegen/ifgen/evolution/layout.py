"""The bytes that values of a type become: the same layout for two types whose values have the same bytes."""

from __future__ import annotations

from typing import Final, TypeAlias

from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)

Layout: TypeAlias = "tuple[tuple[int, Unit], ...]"
"""Units with their number, one after the other; neighbours differ."""

Unit: TypeAlias = "str | tuple[str, Layout]"
"""The name of a basic type, or a sequence or an array with the layout of its elements."""

# One octet each, with the same eight bits for what one calls the same value.
_OCTETS: Final = {"octet": "uint8", "char": "uint8"}
_PLACEHOLDER: Final[Layout] = ((1, "nothing"),)  # the byte of an empty message has no meaning


class Layouts:
    """The layouts of the types in a registry, each worked out once."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry
        self._messages: dict[str, Layout] = {}

    def of(self, type_: FieldType) -> Layout:
        """The layout of values of a type. Bounds are not in it: no byte tells of them."""
        match type_:
            case BasicType(typename):
                return ((1, _OCTETS.get(typename, typename)),)
            case UnboundedString() | BoundedString():
                return ((1, "string"),)
            case UnboundedWString() | BoundedWString():
                return ((1, "wstring"),)
            case NamespacedType():
                return self._of_message(type_.type_name)
            case Array(value_type, size):
                return _repeated(self.of(value_type), size)
            case BoundedSequence(value_type) | UnboundedSequence(value_type):
                return ((1, ("sequence", self.of(value_type))),)

    def _of_message(self, type_name: str) -> Layout:
        if type_name not in self._messages:
            self._messages[type_name] = self.of_message(self._registry.message(type_name))
        return self._messages[type_name]

    def of_message(self, message: Message) -> Layout:
        """The layout of a message: an empty one has a byte, too."""
        units: list[tuple[int, Unit]] = []
        for field in message.fields:
            for count, unit in self.of(field.type):
                before = units.pop()[0] if units and units[-1][1] == unit else 0
                units.append((before + count, unit))
        return tuple(units) or _PLACEHOLDER


def _repeated(layout: Layout, size: int) -> Layout:
    match layout:
        case ((count, unit),):
            return ((count * size, unit),)
        case _:
            return layout if size == 1 else ((size, ("array", layout)),)
