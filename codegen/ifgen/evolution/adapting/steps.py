"""Both versions of a type, and how each field gets its value from the other, or what is left to decide."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal, cast

from ifgen.definition.interfaces import Field, Interface, Message, Registry
from ifgen.definition.meaning.reading import meaning_of
from ifgen.definition.names import attribute_name, snake_case
from ifgen.definition.spelling import spelled
from ifgen.definition.type_description import TypeHashes, referenced_types
from ifgen.definition.types import (
    BoundedSequence,
    CollectionType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.evolution.adapting.conversion import Conversion, convert, question
from ifgen.evolution.messages import paired_fields
from ifgen.generator_py.adapters import FrozenFacts
from ifgen.generator_py.messages.fields import default_value
from ifgen.generator_py.names import interface_name

Today = Callable[[str], "tuple[Interface, Registry] | None"]
"""Finds an interface as it is now by its type name; None if there is none."""


@dataclass
class TwoVersions:
    """An interface as it was and as it is. `origin` is what the old one was read from."""

    old: Interface
    new: Interface
    old_registry: Registry
    new_registry: Registry
    today: Today
    origin: str
    _same: dict[tuple[str, str], bool] = field(default_factory=dict[tuple[str, str], bool])

    @cached_property
    def old_hashes(self) -> TypeHashes:
        """The type hashes of the old version."""
        return TypeHashes(self.old_registry)

    @cached_property
    def new_hashes(self) -> TypeHashes:
        """The type hashes of the new version."""
        return TypeHashes(self.new_registry)

    @cached_property
    def facts(self) -> FrozenFacts:
        """The facts about the old version, with the modules of its frozen classes."""
        return FrozenFacts(self.old_registry, self.frozen)

    @cached_property
    def frozen(self) -> tuple[Interface, ...]:
        """The old interfaces that are no longer there as they were, the adapted one first."""
        held: dict[str, Interface] = {}
        for item in referenced_types(self.old, self.old_registry):
            name = f"{item.package}/{item.folder}/{interface_name(item)}"
            if name == self.old.type_name:
                continue
            interface = self.old_registry.get(name)
            if interface is None:  # only a description can say so
                message = f"{self.old.type_name} holds {item.type_name}, a part of something else"
                raise InputError([Diagnostic("invalid-description", message)])
            held[name] = interface
        return self.old, *(interface for interface in held.values() if not self._is_today(interface))

    def _is_today(self, interface: Interface) -> bool:
        found = self.today(interface.type_name)
        return found is not None and TypeHashes(found[1]).of(found[0]) == self.old_hashes.of(interface)

    def pairs(self, old: Message, new: Message) -> list[tuple[Field | None, Field | None]]:
        """The fields of two messages side by side, one that has been renamed beside itself."""
        return paired_fields(old.fields, new.fields, self._same_type)

    def _same_type(self, old: FieldType, new: FieldType) -> bool:
        if isinstance(old, CollectionType) and isinstance(new, CollectionType):
            resized = type(old) is type(new) and getattr(old, "size", 0) == getattr(new, "size", 0)
            bounds = getattr(old, "maximum_size", 0) == getattr(new, "maximum_size", 0)
            return resized and bounds and self._same_type(old.value_type, new.value_type)
        if isinstance(old, NamespacedType) and isinstance(new, NamespacedType):
            return self.are_versions(old, new)
        return old == new

    def are_versions(self, old: NamespacedType, new: NamespacedType) -> bool:
        """Whether two messages are one in two versions: by name, or by what a renamed one is made of."""
        if old == new:
            return True
        if self.today(old.type_name) is not None:
            return False
        before, after = self.old_registry.message(old.type_name), self.new_registry.message(new.type_name)
        return [(f.name, f.type) for f in before.fields] == [(f.name, f.type) for f in after.fields]

    def is_same(self, old: Message, new: Message) -> bool:
        """Whether messages of both versions are of one class, and mean the same."""
        key = old.type_name, new.type_name
        if key not in self._same:
            is_one = key[0] == key[1] and self.old_hashes.of(old) == self.new_hashes.of(new)
            self._same[key] = is_one and all(
                self._means_same(a, b, old, new) for a, b in self._both(old, new)
            )
        return self._same[key]

    @staticmethod
    def _both(old: Message, new: Message) -> list[tuple[Field, Field]]:
        return list(zip(old.fields, new.fields, strict=True))

    def _means_same(self, a: Field, b: Field, old: Message, new: Message) -> bool:
        if question(a, b, old, new, "") or question(b, a, new, old, ""):
            return False
        one, other = (f.type.value_type if isinstance(f.type, CollectionType) else f.type for f in (a, b))
        if isinstance(one, NamespacedType) and isinstance(other, NamespacedType):
            return self.is_same(
                self.old_registry.message(one.type_name), self.new_registry.message(other.type_name)
            )
        return True


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
    said = meaning_of(field).unit
    unit = f" [{said}]" if said else ""
    what = "is new" if direction == "upgrade" else "is gone since"
    return Step(field, question=f"`{field.name}`{unit} {what}, and has no default")


def _literal(value: object) -> str:
    if isinstance(value, tuple):
        elements = cast("tuple[object, ...]", value)
        return f"[{', '.join(map(_literal, elements))}]"
    if isinstance(value, float) and value - value != 0.0:  # inf or nan
        return f'float("{value}")'
    return json.dumps(value) if isinstance(value, str) else repr(value)
