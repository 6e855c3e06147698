"""Both versions of a type: which classes are frozen, and which messages differ."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

from ifgen.definition.interfaces import Field, Interface, Message, Registry
from ifgen.definition.type_description import TypeHashes, referenced_types
from ifgen.definition.types import CollectionType, FieldType, NamespacedType
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.evolution.adapting.meaning import question
from ifgen.evolution.messages import paired_fields
from ifgen.generator_py.adapters import FrozenFacts
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
