"""Layouts: the structure of a message's body, for the C code that checks payloads without Python.

A layout is a message's table (docs/codec.md, section 2), after those that it calls. A class from an older
ifgen has none. Then the type description becomes tables: one for each type, which calls those of the messages
inside it.
"""

from __future__ import annotations

from array import array
from typing import Any, Final, TypeAlias

from ifgen_runtime.type_support.descriptions import (
    STRINGS,
    WSTRINGS,
    DescribedField,
    Description,
)
from ifgen_runtime.type_support.type_ids import TypeId

Table: TypeAlias = tuple[str, bytes]
"""The rows, and for each type that they refer to the index of its table [uint32]."""

Layout: TypeAlias = tuple[Table, ...]
"""Tables that call only those before them. The last is that of the message itself."""

_LETTERS: Final[dict[int, str]] = {
    TypeId.INT8: "b",
    TypeId.UINT8: "B",
    TypeId.INT16: "h",
    TypeId.UINT16: "H",
    TypeId.INT32: "i",
    TypeId.UINT32: "I",
    TypeId.INT64: "q",
    TypeId.UINT64: "Q",
    TypeId.FLOAT: "f",
    TypeId.DOUBLE: "d",
    TypeId.CHAR: "c",
    TypeId.BOOLEAN: "?",
    TypeId.BYTE: "o",
}


def layout_of(cls: type[Any], description: Description) -> Layout:
    """The layout of a message class, which has this type description."""
    try:
        known: dict[type[Any], Table] = {}
        _add_table(cls, known)
        return tuple(known.values())
    except _NoTable:
        return described_layout(description)


class _NoTable(Exception):
    """A class has none."""


def _add_table(cls: type[Any], known: dict[type[Any], Table]) -> None:
    """The table of a class, after those that it calls."""
    try:
        rows, *classes = vars(cls)["__codec__"][2]
    except KeyError:
        raise _NoTable from None
    called = {int(row.rpartition(".")[2]) for row in rows.split() if row.startswith("C")}
    for index in called:
        if classes[index] not in known:
            _add_table(classes[index], known)
    places = list(known)
    calls = (places.index(of) if index in called else 0 for index, of in enumerate(classes))
    known[cls] = rows, array("I", calls).tobytes()


def described_layout(description: Description) -> Layout:
    """The layout of the described type."""
    writer = _Writer(description)
    writer.table(description.type_name)
    return tuple(writer.tables)


class _Writer:
    def __init__(self, description: Description) -> None:
        self._description = description
        self._known: dict[str, int] = {}
        self.tables: list[Table] = []

    def table(self, type_name: str) -> int:
        """The index of the type's table."""
        if type_name not in self._known:
            rows: list[str] = []
            calls = array("I")
            for field in self._description.fields(type_name):
                rows += self._rows(field, calls)
            self.tables.append((" ".join(rows), calls.tobytes()))
            self._known[type_name] = len(self.tables) - 1
        return self._known[type_name]

    def _rows(self, field: DescribedField, calls: Any) -> list[str]:
        slot = f"0._{field.name}"
        count = f"{field.capacity}.0" if field.is_array else "0.0"
        if field.base == TypeId.NESTED:
            calls.append(self.table(field.nested_type_name))
            message, type_ = len(calls), len(calls) - 1
            if field.is_collection:
                return [f"F{slot}.{message}.{type_}.{count}.1", f"C{message}.{type_}"]
            return ["R1", f"E{slot}.{message}.{type_}", f"C{message}.{type_}"]
        if field.base in STRINGS or field.base in WSTRINGS:
            wide = field.base in WSTRINGS
            if field.is_collection:
                return [f"{'K' if wide else 'L'}{slot}.0.{count}"]
            return [f"{'W' if wide else 'T'}{slot}.0"]
        if field.base not in _LETTERS:
            type_name = self._description.type_name
            raise ValueError(f"{type_name}: field {field.name} has the unknown type id {field.base}")
        letter = _LETTERS[field.base]
        return [f"S{letter}{slot}.{count}"] if field.is_collection else ["R1", f"{letter}{slot}"]
