"""Descriptions of parameters, under their newer names, and of nodes that a container loads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from launch.condition import Condition
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

__all__ = ["ComposableLifecycleNode", "ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]


class ComposableNode:
    """A node that a container loads: the class `plugin` of a package, and what it gets as a Node does."""

    def __init__(
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: Sequence[Any] | None = None,
        remappings: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        extra_arguments: Sequence[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        self.package = normalize_to_list_of_substitutions(package)
        self.node_plugin = normalize_to_list_of_substitutions(plugin)
        self.node_name = _optional(name)
        self.node_namespace = _optional(namespace)
        self.parameters = list(parameters or ())
        self.remappings = list(remappings or ())
        self.extra_arguments = list(extra_arguments or ())
        self._condition = condition

    def condition(self) -> Condition | None:
        """Return the condition; None: it is always loaded."""
        return self._condition


class ComposableLifecycleNode(ComposableNode):
    """A managed node that a container loads; `autostart` activates it."""

    def __init__(self, *, autostart: bool | SomeSubstitutionsType = False, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.autostart = autostart


def _optional(text: SomeSubstitutionsType | None) -> list[Substitution] | None:
    return None if text is None else normalize_to_list_of_substitutions(text)
