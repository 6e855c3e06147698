"""The modules of interfaces as they were: the classes that generating would have made then."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.adapters.context import FrozenModule
from ifgen.generator_py.artifact import Artifact
from ifgen.generator_py.messages.classes import Facts
from ifgen.generator_py.messages.package import interface_module
from ifgen.generator_py.names import TypeName, interface_name, module_name
from ifgen.generator_py.tests.strategies import Strategies

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
