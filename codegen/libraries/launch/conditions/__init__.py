"""Conditions of actions."""

from __future__ import annotations

from launch.condition import Condition
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions._expressions import as_truth
from launch.utilities import described, normalize_to_list_of_substitutions, performed

__all__ = [
    "IfCondition",
    "InvalidConditionExpressionError",
    "LaunchConfigurationEquals",
    "LaunchConfigurationNotEquals",
    "UnlessCondition",
    "evaluate_condition_expression",
]


class InvalidConditionExpressionError(ValueError):
    """The text of a condition is no truth."""


def evaluate_condition_expression(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Return the truth in the text of an expression. Raises InvalidConditionExpressionError."""
    return as_truth(performed(context, expression), InvalidConditionExpressionError)


class IfCondition(Condition):
    """Holds if the text of a predicate is `true` or `1`."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        self.predicate_expression = normalize_to_list_of_substitutions(predicate_expression)
        super().__init__(
            predicate=lambda context: evaluate_condition_expression(context, self.predicate_expression)
        )

    def describe(self) -> str:
        """Return the predicate."""
        return f"IfCondition({described(self.predicate_expression)})"


class UnlessCondition(Condition):
    """Holds if the text of a predicate is `false` or `0`."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        self.predicate_expression = normalize_to_list_of_substitutions(predicate_expression)
        super().__init__(
            predicate=lambda context: not evaluate_condition_expression(context, self.predicate_expression)
        )

    def describe(self) -> str:
        """Return the predicate."""
        return f"UnlessCondition({described(self.predicate_expression)})"


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has this value; None: if it does not exist."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None) -> None:
        self.launch_configuration_name = launch_configuration_name
        self.expected_value = expected_value
        super().__init__(predicate=self._is_equal)

    def _is_equal(self, context: LaunchContext) -> bool:
        expected = None if self.expected_value is None else performed(context, self.expected_value)
        value: object = context.launch_configurations.get(self.launch_configuration_name)
        return value == expected

    def describe(self) -> str:
        """Return the name of the configuration."""
        return f"{type(self).__name__}({self.launch_configuration_name})"


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds if a launch configuration has another value."""

    def _is_equal(self, context: LaunchContext) -> bool:
        return not super()._is_equal(context)
