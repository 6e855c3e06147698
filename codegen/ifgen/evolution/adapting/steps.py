"""How each field of a message gets its value from a message of another version, or what is left to decide."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal, cast

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.names import attribute_name, snake_case
from ifgen.definition.spelling import spelled
from ifgen.definition.types import BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.evolution.adapting.conversion import Conversion, convert
from ifgen.evolution.adapting.meaning import question
from ifgen.evolution.adapting.versions import TwoVersions
from ifgen.generator_py.messages.fields import default_value

Direction = Literal["upgrade", "downgrade"]

PARAMETERS: Final[dict[Direction, str]] = {"upgrade": "old", "downgrade": "new"}
"""The name of the message that a function is given."""


@dataclass(frozen=True, slots=True)
class Step:
    """A field of the target. It gets `conversion` of the field `source`, or a declared `default`.

    If neither is known, or the value means something else, `question` is what a person has to decide.
    """

    target: Field
    source: Field | None = None
    conversion: Conversion | None = None
    default: str = ""
    question: str = ""


@dataclass(frozen=True, slots=True)
class Function:
    """A function from messages of one version to another. `lost` are the fields without a target."""

    name: str
    direction: Direction
    source: Message
    target: Message
    steps: tuple[Step, ...]
    lost: tuple[Field, ...]

    @property
    def is_open(self) -> bool:
        """Whether something is left to decide."""
        return bool(self.lost) or any(step.question for step in self.steps)

    def converted(self) -> Iterator[tuple[str, str]]:
        """The attributes of the target whose values are known from the source, with the text of each."""
        for step in self.steps:
            if step.conversion is not None and not step.question:
                yield attribute_name(step.target), step.conversion.text


class Functions:
    """The functions of a module: those that were asked for, and those that these call."""

    def __init__(self, versions: TwoVersions) -> None:
        self._versions = versions
        self._named: dict[tuple[Direction, str, str], str] = {}
        self._made: dict[str, Function] = {}

    def __iter__(self) -> Iterator[Function]:
        """All functions, those that others call first."""
        return iter(self._made.values())

    def add(self, name: str, direction: Direction, old: Message, new: Message) -> None:
        """Make a function for two versions of a message, after those that it calls."""
        source, target = (old, new) if direction == "upgrade" else (new, old)
        self._named[direction, old.type_name, new.type_name] = name
        pairs = self._versions.pairs(old, new)
        found = [(a, b) if direction == "upgrade" else (b, a) for a, b in pairs]
        by_target = {b.name: a for a, b in found if b is not None}
        steps = tuple(self._step(by_target[b.name], b, direction, source, target) for b in target.fields)
        lost = tuple(a for a, b in found if a is not None and b is None)
        self._made[name] = Function(name, direction, source, target, steps, lost)

    def get(self, direction: Direction, old: Message, new: Message) -> Function | None:
        """The function for two versions of a message; None if there is none."""
        return self._made.get(self._named.get((direction, old.type_name, new.type_name), ""))

    def named(self, name: str) -> Function:
        """The function of this name."""
        return self._made[name]

    def _step(
        self, a: Field | None, b: Field, direction: Direction, source: Message, target: Message
    ) -> Step:
        if a is None:
            return _new(b, direction)
        value = f"{PARAMETERS[direction]}.{attribute_name(a)}"

        def converter(one: NamespacedType, other: NamespacedType) -> str | None:
            return self._function(one, other, direction)

        conversion = convert(a.type, b.type, value, converter)
        if conversion is None:
            types = f"`{spelled(b.type)}`, and `{value}` is `{spelled(a.type)}`"
            narrows = convert(b.type, a.type, "", lambda one, other: "" if one == other else None)
            return Step(b, a, question=f"`{b.name}` is {types}{': does it always fit?' if narrows else ''}")
        return Step(b, a, conversion, question=question(a, b, source, target, value))

    def _function(self, one: NamespacedType, other: NamespacedType, direction: Direction) -> str | None:
        versions = self._versions
        a, b = (one, other) if direction == "upgrade" else (other, one)
        if not versions.are_versions(a, b):
            return None
        old, new = versions.old_registry.message(a.type_name), versions.new_registry.message(b.type_name)
        if versions.is_same(old, new):
            return ""
        key = direction, old.type_name, new.type_name
        if key not in self._named:
            name = f"_{direction}_{snake_case(new.name)}"
            taken = set(self._named.values())
            self.add(f"{name}_of_{new.package}" if name in taken else name, direction, old, new)
        return self._named[key]


def _new(field: Field, direction: Direction) -> Step:
    """A field that only the target has."""
    if field.default_value is not None:
        return Step(field, default=_literal(default_value(field)))
    if isinstance(field.type, BoundedSequence | UnboundedSequence):
        return Step(field, default="[]")
    unit = f" [{field.unit}]" if field.unit else ""
    what = "is new" if direction == "upgrade" else "is gone since"
    return Step(field, question=f"`{field.name}`{unit} {what}, and has no default")


def _literal(value: object) -> str:
    if isinstance(value, tuple):
        elements = cast("tuple[object, ...]", value)
        return f"[{', '.join(map(_literal, elements))}]"
    if isinstance(value, float) and value - value != 0.0:  # inf or nan
        return f'float("{value}")'
    return json.dumps(value) if isinstance(value, str) else repr(value)
