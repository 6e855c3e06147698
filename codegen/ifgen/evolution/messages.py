"""Compares two versions of a message: its fields in order, then its constants and enumerations."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.types import CollectionType, FieldType, NamespacedType
from ifgen.evolution import edits
from ifgen.evolution.edits import MessageEdit, Versions
from ifgen.evolution.values import Layouts, Renamed, accepts, same_constant, same_default


@dataclass(frozen=True, slots=True)
class Comparison:
    """Compares messages: the layouts of all types of both versions, and the names that types have now.

    Constants are left out unless `with_constants`: type descriptions have none.
    """

    old: Layouts
    new: Layouts
    renamed: Renamed
    with_constants: bool = True

    def edits(self, within: Versions) -> Iterator[MessageEdit]:
        """The differences between two versions of a message, those of nested messages left out."""
        if (within.old.fields, within.old.constants) == (within.new.fields, within.new.constants):
            return
        own = list(self._own_edits(within))
        yield from own
        if within.old.constants and self.with_constants:
            yield from _enumerations(within, own)

    def _own_edits(self, within: Versions) -> Iterator[MessageEdit]:
        after = _still_there_after(within)
        for old, new in self.pairs(within):
            if old is None and new is not None:
                yield edits.FieldAdded(within, new)
            elif new is None and old is not None:
                yield edits.FieldRemoved(within, old, after.get(old.name))
            elif old is not None and new is not None:
                if old.name != new.name:
                    yield edits.FieldRenamed(within, old, new)
                yield from self._field(within, old, new)
                if self.with_constants and _commented(old) != _commented(new):
                    yield from _meanings(within, old, new)
        before, now = _by_name(within.old.fields), _by_name(within.new.fields)
        for name in _moved(list(before), list(now)):
            yield edits.FieldMoved(within, before[name], now[name])
        if self.with_constants:
            yield from _constants(within)

    def pairs(self, within: Versions) -> list[tuple[Field | None, Field | None]]:
        """The fields of both versions, side by side."""
        return paired_fields(within.old.fields, within.new.fields, self.same_type)

    def same_type(self, old: FieldType, new: FieldType) -> bool:
        """Whether a type is the same, but for names that have changed as a whole."""
        return self._in_new(old) == new

    def _in_new(self, type_: FieldType) -> FieldType:
        value_type = type_.value_type if isinstance(type_, CollectionType) else type_
        if not isinstance(value_type, NamespacedType):
            return type_
        renamed = NamespacedType(*self.renamed(value_type.type_name).split("/"))
        return replace(type_, value_type=renamed) if isinstance(type_, CollectionType) else renamed

    def _field(self, within: Versions, old: Field, new: Field) -> Iterator[MessageEdit]:
        if self.same_type(old.type, new.type):
            if not same_default(old, new):
                yield edits.DefaultChanged(within, old, new)
            return
        same_layout = self.old.of(old.type) == self.new.of(new.type)
        same_values = accepts(new.type, old.type, self.renamed) and same_default(old, new)
        yield edits.FieldRetyped(within, old, new, same_layout, same_values)


def paired_fields(
    old: Sequence[Field], new: Sequence[Field], same_type: Callable[[FieldType, FieldType], bool]
) -> list[tuple[Field | None, Field | None]]:
    """The fields of both versions, side by side: one that has been renamed is beside itself.

    Renamed are those that have the same type and place as before.
    """
    in_old, in_new = {f.name: f for f in old}, {f.name: f for f in new}
    gone, come = _by_gap(old, in_new), _by_gap(new, in_old)
    renamed = {
        before.name: after
        for gap, fields in gone.items()
        for before, after in zip(fields, come.get(gap, ()), strict=False)
        if same_type(before.type, after.type)
    }
    known = {field.name for field in renamed.values()} | in_old.keys()
    return [
        *((field, renamed.get(field.name, in_new.get(field.name))) for field in old),
        *((None, field) for field in new if field.name not in known),
    ]


def paired_constants(
    old: Sequence[Constant], new: Sequence[Constant]
) -> list[tuple[Constant | None, Constant | None]]:
    """The same for constants: renamed are those that have the same type and value as before."""
    in_old, in_new = {c.name for c in old}, {c.name: c for c in new}
    come = [constant for constant in new if constant.name not in in_old]
    pairs: list[tuple[Constant | None, Constant | None]] = []
    for constant in old:
        beside = in_new.get(constant.name) or _same_value(constant, come)
        if beside in come:
            come.remove(beside)
        pairs.append((constant, beside))
    return [*pairs, *((None, constant) for constant in come)]


def _by_gap(fields: Sequence[Field], in_other: Container[str]) -> dict[str, list[Field]]:
    """The fields that the other version does not have, by the last one before them that it has."""
    gap = ""
    found: dict[str, list[Field]] = {}
    for field in fields:
        if field.name in in_other:
            gap = field.name
        else:
            found.setdefault(gap, []).append(field)
    return found


def _still_there_after(within: Versions) -> dict[str, Field]:
    """The first field after each field of the old version that the new one still has."""
    known = _by_name(within.new.fields)
    found: dict[str, Field] = {}
    after: Field | None = None
    for field in reversed(within.old.fields):
        if after is not None:
            found[field.name] = after
        after = known.get(field.name, after)
    return found


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


def _commented(field: Field) -> object:
    return field.documentation, field.unit, field.annotations


def _meanings(within: Versions, old: Field, new: Field) -> Iterator[MessageEdit]:
    """The differences between the comments of a field: they change its meaning, not the wire."""
    from ifgen.definition.meaning.comparison import differences  # late: few comments change
    from ifgen.definition.meaning.reading import meaning_of

    for found in differences(meaning_of(old), meaning_of(new)):
        yield edits.MeaningChanged(within, old, new, found.aspect, found.one, found.other)


def _by_name(fields: Sequence[Field]) -> dict[str, Field]:
    return {field.name: field for field in fields}


def _constants(within: Versions) -> Iterator[MessageEdit]:
    for old, new in paired_constants(within.old.constants, within.new.constants):
        if old is None and new is not None:
            yield edits.ConstantAdded(within, new)
        elif new is None and old is not None:
            yield edits.ConstantRemoved(within, old)
        elif old is not None and new is not None:
            if old.name != new.name:
                yield edits.ConstantRenamed(within, old, new)
            elif not same_constant(old, new):
                yield edits.ConstantChanged(within, old, new)


def _same_value(old: Constant, come: Sequence[Constant]) -> Constant | None:
    return next((new for new in come if new.type == old.type and same_constant(old, new)), None)


def _enumerations(within: Versions, own: Iterable[MessageEdit]) -> Iterator[edits.EnumChanged]:
    """The enumerations that lack members which no other edit explains."""
    from ifgen.generator_py.names import enum_name  # the generator decides which there are, in few messages

    before, after = _members(within.old), _members(within.new)
    touched = set(_touched(own))
    for name, constants in before.items():
        of_enum = {name, *(constant.name for constant in constants)}
        kept = {constant.name for constant in after.get(name, ())}
        lost = tuple(constant for constant in constants if constant.name not in kept)
        if lost and of_enum.isdisjoint(touched):
            field = next(field for field in within.new.fields if field.name == name)
            yield edits.EnumChanged(within, field, enum_name(field), lost)


def _members(message: Message) -> Mapping[str, tuple[Constant, ...]]:
    """The constants of each enumeration, by the name of its field."""
    # Few messages have any, and the generator loads slowly.
    from ifgen.generator_py.messages.context import enums, values
    from ifgen.generator_py.names import enum_name

    names = {enum.name for enum in enums(message)}
    return {field.name: owned for field, owned in values(message) if enum_name(field) in names}


def _touched(own: Iterable[MessageEdit]) -> Iterator[str]:
    """The fields and constants whose own edits say enough."""
    for edit in own:
        match edit:
            case edits.FieldRemoved(_, field):
                yield field.name
            case edits.ConstantRemoved(_, constant):
                yield constant.name
            case edits.FieldRenamed(_, old) | edits.ConstantRenamed(_, old) | edits.ConstantChanged(_, old):
                yield old.name
            case _:
                pass
