"""Single edits of real definitions: what a test changes, and under which rule that has to be reported."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.types import BasicType, CollectionType, NamespacedType

TYPES = (
    *("bool", "byte", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
    *("float32", "float64", "string", "wstring", "geometry_msgs/Point", "geometry_msgs/Vector3"),
    *("std_msgs/Header", "std_msgs/UInt8", "std_msgs/Empty"),
)
BOUNDS = ("string<=7", "string<=70", "string", "wstring<=7", "wstring<=70", "wstring")


@dataclass(frozen=True)
class Line:
    """A field, or a constant if `constant` is set, with the text of its value if it has one."""

    type: str
    name: str
    value: str | None = None
    constant: bool = False

    def __str__(self) -> str:
        if self.constant:
            return f"{self.type} {self.name}={self.value}\n"
        return f"{self.type} {self.name}{'' if self.value is None else f' {self.value}'}\n"


@dataclass(frozen=True)
class Edit:
    """A definition before and after, the rule that names the difference, and fields that are called otherwise.

    `rule` is None if nothing may be reported, whatever the category.
    """

    rule: str | None
    before: Sequence[Line]
    after: Sequence[Line]
    renamed: Mapping[str, str] = field(default_factory=dict[str, str])


def lines(message: Message) -> list[Line]:
    """A message as lines, with the packages of all types written out."""
    found = [
        Line(spelled(f.type), f.name, None if f.default_value is None else spelled_value(f.default_value))
        for f in message.fields
    ]
    return found + [
        Line(spelled(c.type), c.name, _constant(c.value), constant=True) for c in message.constants
    ]


def _constant(value: object) -> str:
    return (
        str(value[0])
        if isinstance(value, bytes)
        else str(value).lower()
        if isinstance(value, bool)
        else str(value)
    )


def messages(registry: Registry) -> Iterator[Message]:
    """What people wrote: messages, and the parts of services and actions."""
    for interface in registry:
        if isinstance(interface, Message):
            yield interface
        else:
            yield from (part for part in interface.messages if _is_written(part))


def _is_written(part: Message) -> bool:
    values = [f.type.value_type if isinstance(f.type, CollectionType) else f.type for f in part.fields]
    return (
        all(not isinstance(v, NamespacedType) or v.folder == "msg" for v in values)
        and "_Event" not in part.name
    )


def edits(message: Message, chance: random.Random) -> Iterator[Edit]:
    """Every kind of edit of every definition of a message, with types and bounds drawn from all."""
    known = lines(message)
    fields = [line for line in known if not line.constant]
    constants = [line for line in known if line.constant]
    yield Edit(None, known, list(known))
    for at in range(len(fields) + 1):
        added = Line(chance.choice(TYPES), "added_by_the_test")
        yield Edit("field-added", known, [*fields[:at], added, *fields[at:], *constants])
    for at, line in enumerate(fields):
        rest = [*fields[:at], *fields[at + 1 :]]
        yield Edit("field-removed", known, [*rest, *constants])
        other = replace(line, name=f"{line.name}_b")
        after = [*fields[:at], other, *fields[at + 1 :], *constants]
        yield Edit("field-renamed", known, after, {line.name: other.name})
        if rest:
            to = chance.choice([place for place in range(len(fields)) if place != at])
            yield Edit("field-moved", known, [*rest[:to], line, *rest[to:], *constants])
        yield from _retyped(fields, at, constants, chance)
        yield from _defaults(fields, at, constants)
    yield from _constants(fields, constants)


def _retyped(
    fields: Sequence[Line], at: int, constants: Sequence[Line], chance: random.Random
) -> Iterator[Edit]:
    """Another type, another bound, another number of elements; without a default, which might not fit."""
    line = replace(fields[at], value=None)
    base, bracket, size = line.type.partition("[")
    plain = base.partition("<=")[0]
    before = [*fields[:at], line, *fields[at + 1 :], *constants]
    size = bracket + size

    def to(type_: str, rule: str) -> Iterator[Edit]:
        if type_ != line.type and not ("wstring<=" in line.type + type_ and size):
            after = [*fields[:at], replace(line, type=type_), *fields[at + 1 :], *constants]
            yield Edit(rule, before, after)

    for type_ in chance.sample([t for t in TYPES if t != plain], 2):
        yield from to(type_ + size, "field-type")
    for bound in BOUNDS:
        if bound.partition("<=")[0] == plain:
            yield from to(bound + size, "field-bound")
    for other in chance.sample(("", "[]", "[<=4]", "[<=400]", "[1]", "[3]", "[5]"), 2):
        both_sequences = all(text.startswith(("[]", "[<=")) for text in (size, other))
        yield from to(base + other, "field-bound" if both_sequences else "field-array")


def _defaults(fields: Sequence[Line], at: int, constants: Sequence[Line]) -> Iterator[Edit]:
    values = {"bool": ("true", "false"), "string": ('"a"', '"b"'), "float32": ("0.1", "0.2")}
    line = fields[at]
    if "[" in line.type or "/" in line.type or "<=" in line.type:
        return
    first, second = values.get(line.type, ("1", "2"))

    def version(value: str | None) -> list[Line]:
        return [*fields[:at], replace(line, value=value), *fields[at + 1 :], *constants]

    yield Edit("default-value", version(None), version(first if first != "false" else "true"))
    yield Edit("default-value", version(first), version(second))
    yield Edit("default-value", version(second), version(None))
    zero = {"bool": "false", "string": '""', "wstring": '""'}.get(line.type, "0")
    yield Edit(None, version(None), version(zero))


def _constants(fields: Sequence[Line], constants: Sequence[Line]) -> Iterator[Edit]:
    known = [*fields, *constants]
    yield Edit(None, known, [*known, Line("int16", "ADDED_BY_THE_TEST", "-7", constant=True)])
    for at, line in enumerate(constants):
        rest = [*constants[:at], *constants[at + 1 :]]
        yield Edit("constant-removed", known, [*fields, *rest])
        yield Edit("constant-renamed", known, [*fields, *rest, replace(line, name=f"{line.name}_B")])
        other = {"bool": "false" if line.value == "true" else "true", "string": "other"}.get(line.type, "99")
        if other != line.value:
            yield Edit("constant-value", known, [*fields, *rest, replace(line, value=other)])
        if line.type in {"int8", "uint8", "int16", "uint16", "int32", "uint32"}:
            yield Edit(None, known, [*fields, *rest, replace(line, type="int64")])
    if constants:
        yield Edit(None, known, [*constants[::-1], *fields])


def basic_types(message: Message) -> bool:
    """Whether a message holds no other."""
    return all(isinstance(f.type, BasicType) for f in message.fields)
