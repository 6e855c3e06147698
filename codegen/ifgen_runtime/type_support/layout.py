"""Layout programs: the structure of a message's body, for the C code that checks payloads without Python.

The words are defined in `codegen/native/src/layout.h`.
"""

from __future__ import annotations

from array import array
from typing import Final

from ifgen_runtime.type_support.descriptions import (
    SIZES,
    STRINGS,
    WSTRINGS,
    DescribedField,
    Description,
)
from ifgen_runtime.type_support.type_ids import TypeId

_FIXED, _STRING, _WSTRING, _SEQUENCE, _REPEAT, _PART, _CALL = range(1, 8)
_COUNTED: Final = 0xFFFFFFFF
_MOST_INLINED: Final = 48
"""Words of a nested message that stand where it is nested; a longer one is a part, and called."""


def layout_program(description: Description) -> bytes:
    """The layout program of the described type, in native byte order."""
    return array("I", _Program(description).words()).tobytes()


class _Program:
    def __init__(self, description: Description) -> None:
        self._description = description
        self._parts: list[int] = []
        self._known: dict[str, tuple[list[int], int]] = {}

    def words(self) -> list[int]:
        steps, _ = self._message(self._description.type_name)
        return [*self._parts, *steps]

    def _message(self, type_name: str) -> tuple[list[int], int]:
        """The steps of a message, and how deep repetitions and calls go in them."""
        words: list[int] = []
        depth = 0
        for field in self._description.fields(type_name):
            of_field, its_depth = self._field(field)
            words += of_field
            depth = max(depth, its_depth)
        return words, depth

    def _nested(self, type_name: str) -> tuple[list[int], int]:
        """The same where the message is nested: steps, or the call of a part that has them."""
        if type_name not in self._known:
            words, depth = self._message(type_name)
            if len(words) > _MOST_INLINED:
                start = len(self._parts)
                self._parts += [_PART, depth, len(words), *words]
                words, depth = [_CALL, start], depth + 1
            self._known[type_name] = words, depth
        return self._known[type_name]

    def _field(self, field: DescribedField) -> tuple[list[int], int]:
        size = SIZES.get(field.base)
        if size is not None:
            if not field.is_collection:
                return [_FIXED, size, 1], 0
            return [_FIXED, size, field.capacity] if field.is_array else [_SEQUENCE, size], 0
        element, depth = self._element(field)
        if not field.is_collection:
            return element, depth
        count = field.capacity if field.is_array else _COUNTED
        return [_REPEAT, count, len(element), *element], depth + 1

    def _element(self, field: DescribedField) -> tuple[list[int], int]:
        if field.base == TypeId.NESTED:
            return self._nested(field.nested_type_name)
        if field.base in STRINGS:
            return [_STRING], 0
        if field.base in WSTRINGS:
            return [_WSTRING], 0
        type_name = self._description.type_name
        raise ValueError(f"{type_name}: field {field.name} has the unknown type id {field.base}")
