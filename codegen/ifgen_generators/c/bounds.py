"""How much room each field has: its own bound, or that of the option `bounds`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final

from ifgen.model import Field, Message

_UTF8: Final = 4
_UTF16: Final = 2
MAX_CHARACTERS: Final = 0xFFFF
"""The largest number of characters that a row of the codec's table can say."""


@dataclass(frozen=True, slots=True)
class Room:
    """The most elements of a sequence, and the most bytes (UTF-16 units in a wide string) of each string."""

    elements: int | None = None
    text: int | None = None


@dataclass(frozen=True, slots=True)
class Unbounded:
    """A field that nothing bounds, with the key that would."""

    field: Field
    key: str
    pattern: str


class Bounds:
    """The room of each field.

    Keys are `pkg/msg/Name.field`, and `pkg/msg/Name.field[]` for the strings of an array or a sequence.
    Either part may be a pattern, and `*.string`, `*.wstring` and `*.sequence` stand for all fields of a kind.
    A key that names one field wins over patterns, of which the first that matches counts. Patterns do not
    change what an interface bounds itself.
    """

    def __init__(self, bounds: Mapping[str, int]) -> None:
        self._bounds = bounds
        self._rooms: dict[str, Room] = {}
        self.unbounded: list[Unbounded] = []
        self.overflowing: list[Field] = []
        self.unused = {key for key in bounds if not any(character in key for character in "*?")}

    def add(self, message: Message) -> None:
        """Find the room for the fields of a message: `unbounded` and `overflowing` have too little."""
        for field in message.fields:
            room = self._rooms[field.id] = Room(self._elements(message, field), self._text(message, field))
            if self.unbounded and self.unbounded[-1].field is field:
                continue
            values = field.default_elements or ((field.default_value,) if field.default_value else ())
            lengths = (_length(str(value.value), field.type.primitive) for value in values)
            if len(values) > (room.elements or 1) or (
                room.text is not None and max(lengths, default=0) > room.text
            ):
                self.overflowing.append(field)

    def of(self, field: Field) -> Room:
        """The room of a field of a message that was added."""
        return self._rooms[field.id]

    def _elements(self, message: Message, field: Field) -> int | None:
        if not field.type.many or field.type.size is not None:
            return field.type.size
        return self._bound(message, field, "sequence", field.name, field.type.maximum_size)

    def _text(self, message: Message, field: Field) -> int | None:
        kind = field.type.primitive
        if kind not in {"string", "wstring"}:
            return None
        declared = field.type.string_bound
        if declared is not None and declared <= MAX_CHARACTERS:
            declared *= _UTF8 if kind == "string" else _UTF16
        name = f"{field.name}[]" if field.type.many else field.name
        room = self._bound(message, field, kind, name, declared)
        # An even number of units fills the struct, so that its size says how many there are.
        return room + room % 2 if kind == "wstring" else room

    def _bound(self, message: Message, field: Field, kind: str, name: str, declared: int | None) -> int:
        exact = f"{message.type_name}.{name}"
        self.unused.discard(exact)
        if exact in self._bounds:
            return self._bounds[exact]
        if declared is not None:
            return declared
        for key in self._patterns():
            owner, _, of = key.rpartition(".")
            if fnmatchcase(message.type_name, owner) and (
                of == kind or fnmatchcase(name, of.replace("[", "[[]"))
            ):
                return self._bounds[key]
        self.unbounded.append(Unbounded(field, exact, f"*.{kind}"))
        return 1

    def _patterns(self) -> Iterator[str]:
        return (key for key in self._bounds if "*" in key or "?" in key)


def _length(text: str, primitive: str) -> int:
    return len(text.encode()) if primitive == "string" else len(text.encode("utf-16-le")) // _UTF16
