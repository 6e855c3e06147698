"""Hypothesis strategies for messages of any generated class: every value that the wire can hold."""

from __future__ import annotations

from array import array
from typing import Any

import numpy
from hypothesis import strategies as st
from ifgen_runtime.codec import creator
from ifgen_runtime.field_types import Basic, Field, Text, fields_of

MAX_ELEMENTS = 4
"""Sequences without a bound get at most so many elements."""


_KNOWN: dict[type, st.SearchStrategy[Any]] = {}


def messages(cls: type[Any]) -> st.SearchStrategy[Any]:
    """Messages of this class. NaN is left out, so that equal messages are equal."""
    if cls not in _KNOWN:
        fields = st.tuples(*(_field(field) for field in fields_of(cls)))
        _KNOWN[cls] = fields.map(lambda values: _filled(cls, values))
    return _KNOWN[cls]


def _filled(cls: type[Any], values: tuple[Any, ...]) -> Any:
    message = creator(cls)()
    for field, value in zip(fields_of(cls), values, strict=True):
        setattr(message, field.slot, value)
    return message


def _field(field: Field) -> st.SearchStrategy[Any]:
    value = values(field.type)
    if not field.is_collection:
        return value
    if field.size is not None:
        size = field.size
        elements = st.lists(value, min_size=size, max_size=size)
        if size > 16:  # one drawn element has to be enough for a large array
            elements = value.map(lambda element: [element] * size)
    else:
        elements = st.lists(value, max_size=min(MAX_ELEMENTS, field.maximum or MAX_ELEMENTS))
    if not isinstance(field.type, Basic) or not field.type.typecode:
        return elements
    if field.size is None:
        typecode = field.type.typecode
        return elements.map(lambda numbers: array(typecode, numbers))
    dtype = field.type.dtype
    return elements.map(lambda numbers: numpy.array(numbers, dtype))


def values(type_: Basic | Text | type[Any]) -> st.SearchStrategy[Any]:
    """Values of a field type that is neither an array nor a sequence."""
    if isinstance(type_, Text):
        # NUL ends a string on the wire, and half of a surrogate pair has no UTF-8. A wstring can hold NUL.
        exclude = "" if type_.wide else "\0"
        characters = st.characters(exclude_categories=["Cs"], exclude_characters=exclude)
        return st.text(characters, max_size=type_.maximum if type_.maximum is not None else 12)
    if not isinstance(type_, Basic):
        return messages(type_)
    if type_.name == "boolean":
        return st.booleans()
    if type_.name == "octet":
        return st.binary(min_size=1, max_size=1)
    if type_.name == "char":
        return st.characters(max_codepoint=255)
    if type_.is_float:
        return st.floats(allow_nan=False, width=32 if type_.name == "float" else 64)
    return st.integers(*type_.range)
