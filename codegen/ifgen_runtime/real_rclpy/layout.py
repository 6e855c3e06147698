"""Layouts: the structure of a message's body, for the C code that checks payloads without Python.

A layout is a message's table (docs/codec.md, section 2), after those that it calls. A class from an older
ifgen has none. Then the type description becomes tables: one for each type, which calls those of the messages
inside it.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from ifgen_runtime.type_description import Kind, TypeId

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


STRINGS: Final[frozenset[int]] = frozenset({TypeId.STRING, TypeId.FIXED_STRING, TypeId.BOUNDED_STRING})
WSTRINGS: Final[frozenset[int]] = frozenset({TypeId.WSTRING, TypeId.FIXED_WSTRING, TypeId.BOUNDED_WSTRING})


@dataclass(frozen=True, slots=True)
class DescribedField:
    """A field: `base` is the type id of the value or element, `capacity` is 0 for any number."""

    name: str
    base: int
    kind: int
    capacity: int
    string_capacity: int
    nested_type_name: str

    @property
    def is_collection(self) -> bool:
        """Whether it is an array or a sequence."""
        return self.kind != Kind.VALUE

    @property
    def is_array(self) -> bool:
        """Whether it has exactly `capacity` elements."""
        return self.kind == Kind.ARRAY

    @property
    def is_bounded(self) -> bool:
        """Whether it is a sequence of at most `capacity` elements."""
        return self.kind == Kind.BOUNDED_SEQUENCE


class Description:
    """The description of a type, with those of everything that it refers to."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self.individual: Mapping[str, Any] = document["type_description"]
        self.referenced: tuple[Mapping[str, Any], ...] = tuple(document["referenced_type_descriptions"])
        self._individuals = {item["type_name"]: item for item in (self.individual, *self.referenced)}

    @property
    def type_name(self) -> str:
        """`pkg/msg/Name`."""
        return str(self.individual["type_name"])

    def fields(self, type_name: str) -> Iterator[DescribedField]:
        """The fields of the described type or of one that it refers to."""
        for field in self._individuals[type_name]["fields"]:
            of = field["type"]
            base = of["type_id"] % Kind.ARRAY
            kind = of["type_id"] - base
            yield DescribedField(
                field["name"], base, kind, of["capacity"], of["string_capacity"], of["nested_type_name"]
            )


def split(type_name: str) -> tuple[str, str, str]:
    """Package, folder and name."""
    package, folder, name = type_name.split("/")
    return package, folder, name


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
