# Defaults of users are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Texts, launch configurations, and texts put together."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions, performed


class TextSubstitution(Substitution):
    """A text as it is."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
            raise TypeError(f"TextSubstitution expects a text, got {text!r}")
        self.text = text

    def describe(self) -> str:
        """Return the text in quotes."""
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch configuration, such as an argument."""

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None) -> None:
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        if default is None:
            self.default = None
        else:
            values = default if isinstance(default, list | tuple) else [default]
            self.default = normalize_to_list_of_substitutions(
                [value if isinstance(value, Substitution) else str(value) for value in values]
            )

    def describe(self) -> str:
        """Return its name."""
        return f"LaunchConfig({described(self.variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return its value, or the default. Raises SubstitutionFailure."""
        name = perform_substitutions(context, self.variable_name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform_substitutions(context, self.default)


class LocalSubstitution(Substitution):
    """A value that the context has for the event that is handled, such as `event.returncode`."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self.description = description

    def describe(self) -> str:
        """Return its description, or its expression."""
        return f"LocalVar('{self.description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        """Return its value as a text. Raises SubstitutionFailure."""
        name, *attributes = self.expression.split(".")
        value: Any = context.get_locals_as_dict()
        try:
            value = value[name]
            for attribute in attributes:
                value = getattr(value, attribute)
        except (KeyError, AttributeError):
            raise SubstitutionFailure(f"there is no local '{self.expression}' here") from None
        return str(value)


class StringJoinSubstitution(Substitution):
    """Texts with a delimiter between them."""

    def __init__(
        self, substitutions: Iterable[SomeSubstitutionsType], delimiter: SomeSubstitutionsType = ""
    ) -> None:
        self.substitutions = [normalize_to_list_of_substitutions(each) for each in substitutions]
        self.delimiter = normalize_to_list_of_substitutions(delimiter)

    def describe(self) -> str:
        """Return its parts."""
        return f"StringJoin({', '.join(map(described, self.substitutions))})"

    def perform(self, context: LaunchContext) -> str:
        """Return the joined text."""
        return performed(context, self.delimiter).join(
            perform_substitutions(context, each) for each in self.substitutions
        )
