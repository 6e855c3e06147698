# Modules that users name are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Truths, and expressions of Python."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions


def truth(context: LaunchContext, subs: Sequence[Substitution]) -> bool:
    """Return the truth in a text: true or 1, false or 0. Raises SubstitutionFailure."""
    text = perform_substitutions(context, subs)
    return as_truth(text, SubstitutionFailure)


def as_truth(text: str, error: Callable[[str], Exception]) -> bool:
    """Return the truth in a text, yes/no and on/off as well; raise this error if there is none."""
    match text.strip().lower():
        case "true" | "1" | "yes" | "on":
            return True
        case "false" | "0" | "no" | "off":
            return False
        case _:
            raise error(f"expected 'true', 'false', '1' or '0', got '{text}'")


class PythonExpression(Substitution):
    """The value of an expression of Python, such as `'2' + ' * 3'`, with modules that it may use."""

    def __init__(
        self, expression: SomeSubstitutionsType, python_modules: SomeSubstitutionsType = ("math",)
    ) -> None:
        self.expression = normalize_to_list_of_substitutions(expression)
        written = [python_modules] if isinstance(python_modules, str | Substitution) else python_modules
        self.python_modules = [normalize_to_list_of_substitutions(each) for each in written]  # type: ignore[union-attr]  # no Path names a module

    def describe(self) -> str:
        """Return the expression."""
        return f"PythonExpr({described(self.expression)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value as a text. Raises SubstitutionFailure."""
        expression = perform_substitutions(context, self.expression)
        if not context.runs_python:
            raise SubstitutionFailure(f"the Python expression '{expression}' is not to be run")
        names: dict[str, Any] = {}
        try:
            for module in self.python_modules:
                name = perform_substitutions(context, module)
                names[name] = importlib.import_module(name)
            if "math" in names:
                names |= {name: value for name, value in vars(names["math"]).items() if name[0] != "_"}
            return str(eval(expression, {}, names))
        except Exception as error:
            raise SubstitutionFailure(
                f"the Python expression '{expression}' fails: {type(error).__name__}: {error}"
            ) from None


class NotSubstitution(Substitution):
    """The opposite of a truth."""

    def __init__(self, value: SomeSubstitutionsType) -> None:
        self.value = normalize_to_list_of_substitutions(value)

    def describe(self) -> str:
        """Return its operand."""
        return f"NotSubstitution({described(self.value)})"

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`. Raises SubstitutionFailure."""
        return _word(not truth(context, self.value))


class _OfTwo(Substitution):
    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        self.left = normalize_to_list_of_substitutions(left)
        self.right = normalize_to_list_of_substitutions(right)

    def describe(self) -> str:
        """Return its operands."""
        return f"{type(self).__name__}({described(self.left)} {described(self.right)})"


class AndSubstitution(_OfTwo):
    """Two truths that both hold."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`. Raises SubstitutionFailure."""
        left, right = truth(context, self.left), truth(context, self.right)
        return _word(left and right)


class OrSubstitution(_OfTwo):
    """Two truths of which one holds at least."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`. Raises SubstitutionFailure."""
        left, right = truth(context, self.left), truth(context, self.right)
        return _word(left or right)


class EqualsSubstitution(Substitution):
    """Two texts that are the same: as truths, as numbers or as texts."""

    def __init__(self, left: Any, right: Any) -> None:
        self.left = _normalized(left)
        self.right = _normalized(right)

    def describe(self) -> str:
        """Return its operands."""
        return f"{type(self).__name__}({described(self.left)} {described(self.right)})"

    def holds(self, context: LaunchContext) -> bool:
        """Return whether they are the same."""
        left, right = perform_substitutions(context, self.left), perform_substitutions(context, self.right)
        with suppress(ValueError):
            return as_truth(left, ValueError) is as_truth(right, ValueError)
        try:
            return abs(float(left) - float(right)) <= 1e-9 * max(abs(float(left)), abs(float(right)))
        except ValueError:
            return left == right

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _word(self.holds(context))


class NotEqualsSubstitution(EqualsSubstitution):
    """Two texts that are not the same."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _word(not self.holds(context))


class _OfMany(Substitution):
    def __init__(self, *args: SomeSubstitutionsType) -> None:
        self.args = [normalize_to_list_of_substitutions(each) for each in args]

    def describe(self) -> str:
        """Return its operands."""
        return f"{type(self).__name__}({' '.join(map(described, self.args))})"

    def truths(self, context: LaunchContext) -> list[bool]:
        """Return the truth of each, also after the one that decides. Raises SubstitutionFailure."""
        return [truth(context, each) for each in self.args]


class AnySubstitution(_OfMany):
    """Truths of which one holds at least."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`. Raises SubstitutionFailure."""
        return _word(any(self.truths(context)))


class AllSubstitution(_OfMany):
    """Truths that all hold."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`. Raises SubstitutionFailure."""
        return _word(all(self.truths(context)))


class IfElseSubstitution(Substitution):
    """One of two texts, by a truth."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ) -> None:
        if if_value == "" and else_value == "":
            raise RuntimeError("IfElseSubstitution needs an if_value or an else_value")
        self.condition = normalize_to_list_of_substitutions(condition)
        self.if_value = normalize_to_list_of_substitutions(if_value)
        self.else_value = normalize_to_list_of_substitutions(else_value)

    def describe(self) -> str:
        """Return its three parts."""
        parts = ", ".join(map(described, (self.condition, self.if_value, self.else_value)))
        return f"IfElseSubstitution({parts})"

    def perform(self, context: LaunchContext) -> str:
        """Return the text that was chosen. Raises SubstitutionFailure."""
        chosen = self.if_value if truth(context, self.condition) else self.else_value
        return perform_substitutions(context, chosen)


def _normalized(value: Any) -> list[Substitution]:
    if value is None:
        return []
    return normalize_to_list_of_substitutions(str(value) if isinstance(value, int | float) else value)


def _word(holds: bool) -> str:
    return "true" if holds else "false"
