"""Modules that convert messages of another version of a type (docs/adapters.md).

The contexts of adapters and of their tests are frozen dataclasses whose strings are finished Python text. The
modules of old versions hold the classes that generating would have made then.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.artifact import Artifact
from ifgen.generator_py.messages.classes import Facts
from ifgen.generator_py.messages.package import interface_module
from ifgen.generator_py.names import TypeName, interface_name, module_name
from ifgen.generator_py.tests.strategies import Strategies


@dataclass(frozen=True, slots=True)
class FrozenModule:
    """The module of an interface as it was.

    `home` is the `__name__` that its classes know it by, which tells ROS the name of the type. `classes` are
    their names.
    """

    home: str
    classes: str


@dataclass(frozen=True, slots=True)
class ValueText:
    """An argument of a constructor: `name` is the field. `note` is the comment beside it.

    `question` is what a person has to decide, as a Python string; then there is no `value`.
    """

    name: str
    value: str
    note: str
    question: str


@dataclass(frozen=True, slots=True)
class LostText:
    """A value that the target has no field for, and what a person has to decide, as a Python string."""

    value: str
    question: str


@dataclass(frozen=True, slots=True)
class FunctionText:
    """A function that makes a message of class `result` of a message of class `source`."""

    head: str
    docstring: str
    result: str
    lost: tuple[LostText, ...]
    values: tuple[ValueText, ...]


@dataclass(frozen=True, slots=True)
class RegistrationText:
    """An adapter as it is registered: its arguments, as (name, value)."""

    arguments: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class AdapterModule:
    """A module of adapters. `origin` is what the old version was read from, as somebody wrote it."""

    title: str
    origin: str
    old_hash: str
    new_hash: str
    imports: tuple[str, ...]
    functions: tuple[FunctionText, ...]
    registrations: tuple[RegistrationText, ...]
    is_open: bool


@dataclass(frozen=True, slots=True)
class AdapterPackage:
    """The folder of adapters."""

    title: str


@dataclass(frozen=True, slots=True)
class CheckText:
    """A function of a test that compares two messages: its statements, in order."""

    head: str
    docstring: str
    statements: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AdapterCase:
    """A message, or a part of a service or an action, in the tests of an adapter.

    `name` is in capitals, and `title` a comment. `old` and `new` are its classes, and `old_messages` and
    `new_messages` strategies for them. `populated` makes an old message without any default in it, and
    `recorded` are its bytes, in lines of hexadecimal digits. `fields` are those that `upgrade` sets then.
    `check` compares a message with the one that it was made of, `check_downgrade` the other way, and `kept` a
    message with what is left of it after `downgrade` and `upgrade`. The last three are empty without a
    downgrade.
    """

    name: str
    title: str
    old: str
    new: str
    old_hash: str
    upgrade: str
    check: str
    downgrade: str
    check_downgrade: str
    kept: str
    populated: str
    recorded: tuple[str, ...]
    fields: str
    old_messages: str
    new_messages: str


@dataclass(frozen=True, slots=True)
class AdapterTests:
    """The tests of a module of adapters; `module` is its name.

    `imports` are modules of message classes, and `own_import` is the statement that imports those of frozen
    ones. `values` and `strategies` are those of hypothesis, as (name, strategy).
    """

    title: str
    module: str
    imports: tuple[str, ...]
    own_import: str
    values: tuple[tuple[str, str], ...]
    strategies: tuple[tuple[str, str], ...]
    checks: tuple[CheckText, ...]
    cases: tuple[AdapterCase, ...]


_DIGITS = 8


def short(type_hash: str) -> str:
    """The first digits of a hash, which tell versions of a type apart."""
    return type_hash.removeprefix("RIHS01_")[:_DIGITS]


class FrozenFacts(Facts):
    """The facts about an old version: `changed` are the interfaces whose classes are frozen."""

    def __init__(self, registry: Registry, changed: Iterable[Interface]) -> None:
        super().__init__(registry)
        self.modules: Mapping[str, str] = {
            interface.type_name: f"{module_name(interface.name)}_{short(self.hashes.of(interface))}"
            for interface in changed
        }
        """The names of the modules of frozen interfaces, by type name."""

    def frozen_module(self, type_: TypeName) -> str | None:
        """The module of a message class; None if the class is today's."""
        return self.modules.get(f"{type_.package}/{type_.folder}/{interface_name(type_)}")

    def module_of(self, type_: NamespacedType) -> str:
        """The module that other modules import a message class from."""
        frozen = self.frozen_module(type_)
        return super().module_of(type_) if frozen is None else f".{frozen}"


def plan_frozen(interface: Interface, facts: FrozenFacts) -> Artifact:
    """The module of an interface as it was."""
    type_hash = facts.hashes.of(interface)
    module = interface_module(
        interface if _has_own_source(interface) else replace(interface, source=None), facts
    )
    variables = {
        "module": replace(
            module, title=f"`{interface.type_name}` as it was: frozen by `ifgen adapt`, do not edit."
        ),
        "frozen": FrozenModule(
            classes=", ".join(
                c.name for c in (*module.messages, *module.services, module.action) if c is not None
            ),
            home=f"{interface.package}.{interface.folder}.{module_name(interface.name)}@{short(type_hash)}",
        ),
    }
    return Artifact(f"{facts.modules[interface.type_name]}.py", "adapter_package/frozen.py.j2", variables)


def _has_own_source(interface: Interface) -> bool:
    """Whether the source of an interface is a file of its own, and not one of many, such as a lock file."""
    return interface.source is not None and interface.source.path.stem == interface.name


class OldStrategies(Strategies):
    """The strategies for an old version, whose classes are frozen where they differ from today's."""

    def __init__(self, registry: Registry, facts: FrozenFacts) -> None:
        super().__init__(registry)
        self._facts = facts
        self.frozen: set[str] = set()
        """The modules of the frozen classes."""

    def message_class(self, type_: Message | NamespacedType) -> str:
        """The name of a message class in the test module: `_add_two_ints_3c76ee04.AddTwoInts.Request`."""
        module = self._facts.frozen_module(type_)
        if module is None:
            return super().message_class(type_)
        self.frozen.add(module)
        interface = interface_name(type_)
        part = type_.name.removeprefix(interface).lstrip("_")
        return ".".join((module, interface, *([part] if part else [])))

    def strategy_name(self, message: Message) -> str:
        """The name of the strategy for messages of this class, in the test module."""
        module = self._facts.frozen_module(message)
        suffix = "" if module is None else f"_{module.rpartition('_')[2]}"
        return super().strategy_name(message) + suffix
