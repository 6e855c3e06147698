"""Layout programs: what the body of a message is made of, for the C code that checks payloads without Python.

The words are those of `codegen/native/src/layout.h`.
"""

from __future__ import annotations

from array import array
from typing import Final

from ifgen_runtime.type_support.descriptions import (
    NESTED,
    SIZES,
    STRINGS,
    WSTRINGS,
    DescribedField,
    Description,
)

_FIXED, _STRING, _WSTRING, _SEQUENCE, _REPEAT = 1, 2, 3, 4, 5
_COUNTED: Final = 0xFFFFFFFF


def layout_program(description: Description) -> bytes:
    """The layout program of the described type, in native byte order."""
    return array("I", _words(description, description.type_name)).tobytes()


def _words(description: Description, type_name: str) -> list[int]:
    words: list[int] = []
    for field in description.fields(type_name):
        words += _field(description, field)
    return words


def _field(description: Description, field: DescribedField) -> list[int]:
    size = SIZES.get(field.base)
    if size is not None:
        if not field.is_collection:
            return [_FIXED, size, 1]
        return [_FIXED, size, field.capacity] if field.is_array else [_SEQUENCE, size]
    if field.base == NESTED:
        element = _words(description, field.nested_type_name)
    elif field.base in STRINGS:
        element = [_STRING]
    elif field.base in WSTRINGS:
        element = [_WSTRING]
    else:
        raise ValueError(f"{description.type_name}: field {field.name} has the unknown type id {field.base}")
    if not field.is_collection:
        return element
    return [_REPEAT, field.capacity if field.is_array else _COUNTED, len(element), *element]
