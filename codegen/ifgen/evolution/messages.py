"""Compares two versions of a message: its fields in order, then its constants."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ifgen.definition.interfaces import Constant, Field
from ifgen.definition.types import CollectionType, FieldType, NamespacedType
from ifgen.evolution.edits import (
    ConstantAdded,
    ConstantChanged,
    ConstantRemoved,
    ConstantRenamed,
    DefaultChanged,
    FieldAdded,
    FieldMoved,
    FieldRemoved,
    FieldRenamed,
    FieldRetyped,
    MessageEdit,
    Versions,
)
from ifgen.evolution.layout import Layouts
from ifgen.evolution.python_values import Renamed, accepts, same_constant, same_default


@dataclass(frozen=True, slots=True)
class Comparison:
    """Compares messages: the layouts of all types of both versions, and the names that types have now."""

    old: Layouts
    new: Layouts
    renamed: Renamed

    def edits(self, within: Versions) -> Iterator[MessageEdit]:
        """The differences between two versions of a message, those of nested messages left out."""
        if (within.old.fields, within.old.constants) == (within.new.fields, within.new.constants):
            return
        edits = list(self._own_edits(within))
        yield from edits
        if within.old.constants:
            from ifgen.evolution.enumerations import lost_members  # with the generator, for few messages

            yield from lost_members(within, edits)

    def _own_edits(self, within: Versions) -> Iterator[MessageEdit]:
        for old, new in self.pairs(within):
            if old is None and new is not None:
                yield FieldAdded(within, new)
            elif new is None and old is not None:
                yield FieldRemoved(within, old, _instead(within, old))
            elif old is not None and new is not None:
                if old.name != new.name:
                    yield FieldRenamed(within, old, new)
                yield from self._field(within, old, new)
        moved = _moved([field.name for field in within.old.fields], [f.name for f in within.new.fields])
        for name in moved:
            old, new = _named(within.old.fields, name), _named(within.new.fields, name)
            yield FieldMoved(within, old, new)
        yield from _constants(within)

    def pairs(self, within: Versions) -> list[tuple[Field | None, Field | None]]:
        """The fields of both versions, side by side: one that has been renamed is beside itself."""
        old, new = within.old.fields, within.new.fields
        in_old, in_new = {f.name: f for f in old}, {f.name: f for f in new}
        renamed = self._renamed(old, new)
        gone_to = dict(renamed)
        come = set(gone_to.values())
        pairs: list[tuple[Field | None, Field | None]] = [
            (field, in_new.get(gone_to.get(field.name, field.name))) for field in old
        ]
        pairs += ((None, f) for f in new if f.name not in in_old and f.name not in come)
        return pairs

    def same_type(self, old: FieldType, new: FieldType) -> bool:
        """Whether a type is the same, but for names that have changed as a whole."""
        return self._in_new(old) == new

    def _in_new(self, type_: FieldType) -> FieldType:
        value_type = type_.value_type if isinstance(type_, CollectionType) else type_
        if not isinstance(value_type, NamespacedType):
            return type_
        renamed = NamespacedType(*self.renamed(value_type.type_name).split("/"))
        return replace(type_, value_type=renamed) if isinstance(type_, CollectionType) else renamed

    def _renamed(self, old: Sequence[Field], new: Sequence[Field]) -> list[tuple[str, str]]:
        """The old and the new names of fields that have the same type and place as before."""
        in_old, in_new = {f.name for f in old}, {f.name for f in new}
        gone = _by_gap(old, in_new)
        come = _by_gap(new, in_old)
        return [
            (before.name, after.name)
            for gap, fields in gone.items()
            for before, after in zip(fields, come.get(gap, ()), strict=False)
            if self.same_type(before.type, after.type)
        ]

    def _field(self, within: Versions, old: Field, new: Field) -> Iterator[MessageEdit]:
        if self.same_type(old.type, new.type):
            if not same_default(old, new):
                yield DefaultChanged(within, old, new)
            return
        same_layout = self.old.of(old.type) == self.new.of(new.type)
        same_values = accepts(new.type, old.type, self.renamed) and same_default(old, new)
        yield FieldRetyped(within, old, new, same_layout, same_values)


def _by_gap(fields: Sequence[Field], in_other: set[str]) -> dict[str, list[Field]]:
    """The fields that the other version does not have, by the last one before them that it has."""
    gap = ""
    found: dict[str, list[Field]] = {}
    for field in fields:
        if field.name in in_other:
            gap = field.name
        else:
            found.setdefault(gap, []).append(field)
    return found


def _instead(within: Versions, removed: Field) -> Field | None:
    """The first field after a removed one that is still there."""
    after = within.old.fields[within.old.fields.index(removed) + 1 :]
    known = {field.name: field for field in within.new.fields}
    return next((known[field.name] for field in after if field.name in known), None)


def _moved(old: Sequence[str], new: Sequence[str]) -> list[str]:
    """The fewest names of both sequences whose moves make one order of the other."""
    places = {name: place for place, name in enumerate(new)}
    common = [name for name in old if name in places]
    ends: list[int] = []  # the smallest last place of an ascending sequence of each length
    at: list[int] = []
    for name in common:
        length = bisect_left(ends, places[name])
        ends[length : length + 1] = [places[name]]
        at.append(length)
    stays: set[str] = set()
    length = len(ends) - 1
    for name, its in zip(reversed(common), reversed(at), strict=True):
        if its == length:
            stays.add(name)
            length -= 1
    return [name for name in common if name not in stays]


def _named(fields: Sequence[Field], name: str) -> Field:
    return next(field for field in fields if field.name == name)


def _constants(within: Versions) -> Iterator[MessageEdit]:
    in_old = {constant.name: constant for constant in within.old.constants}
    in_new = {constant.name: constant for constant in within.new.constants}
    come = [constant for constant in within.new.constants if constant.name not in in_old]
    for old in within.old.constants:
        if (same := in_new.get(old.name)) is not None:
            if not same_constant(old, same):
                yield ConstantChanged(within, old, same)
        elif (new := _same_value(old, come)) is not None:
            come.remove(new)
            yield ConstantRenamed(within, old, new)
        else:
            yield ConstantRemoved(within, old)
    yield from (ConstantAdded(within, constant) for constant in come)


def _same_value(old: Constant, come: Sequence[Constant]) -> Constant | None:
    return next((new for new in come if new.type == old.type and same_constant(old, new)), None)
