"""Hypothesis strategies for messages of an old version."""

from __future__ import annotations

from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.adapters.frozen import FrozenFacts
from ifgen.generator_py.names import interface_name
from ifgen.generator_py.tests.strategies import Strategies


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
