"""Type descriptions (REP-2016) as the type support reads them: field by field, type ids taken apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from ifgen_runtime.type_support.type_ids import Kind, TypeId

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
