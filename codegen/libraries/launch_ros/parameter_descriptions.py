# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Parameters of nodes: values with their types, files, and single ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args, get_origin

import yaml
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions, performed

from launch_ros._template import filled

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]

_SCALARS = (bool, int, float, str)


class ParameterValue:
    """A value that may have substitutions; with `value_type` the type that its text stands for."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = value
        self.value_type = value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value. Raises TypeError if its text does not stand for that type."""
        return typed(texts_of(context, self.value), self.value_type)


class ParameterFile:
    """A file of parameters; with `allow_substs` its text may have substitutions such as `$(var x)`."""

    def __init__(
        self, param_file: SomeSubstitutionsType, *, allow_substs: bool | SomeSubstitutionsType = False
    ) -> None:
        self.param_file = normalize_to_list_of_substitutions(param_file)
        self.allow_substs = str(allow_substs) if isinstance(allow_substs, bool) else allow_substs

    def evaluate(self, context: LaunchContext) -> Path:
        """Return the path of the file, or of a copy without substitutions. Raises RuntimeError."""
        path = perform_substitutions(context, self.param_file)
        if performed(context, self.allow_substs).lower() not in {"true", "1"}:
            return Path(path)
        return Path(context.host.text_file(filled(path, context)))


class Parameter:
    """One parameter: its name, and its value as in ParameterValue."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.value = ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return the name and the value. Raises TypeError."""
        return perform_substitutions(context, self.name), self.value.evaluate(context)


class Text(str):
    """A text that substitutions made, whose type is still to be found."""


def texts_of(context: LaunchContext, value: Any) -> Any:
    """Return a value with its substitutions performed; their texts are `Text`."""
    if isinstance(value, Substitution):
        return Text(value.perform(context))
    if isinstance(value, list | tuple) and _is_one_text(value):
        return Text(performed(context, value))
    if isinstance(value, list | tuple):
        return [texts_of(context, each) for each in value]
    return value


def _is_one_text(parts: Sequence[Any]) -> bool:
    """Whether a list with substitutions stands for one text, as upstream has it."""
    has_substitution = any(isinstance(each, Substitution) for each in parts)
    return has_substitution and all(isinstance(each, str | Substitution) for each in parts)


def typed(value: Any, wanted: Any) -> Any:
    """Return a value of the type that is wanted; None: of the one that YAML reads in a Text.

    Raises TypeError.
    """
    if wanted is None:
        return _of_any_type(value)
    item = get_args(wanted)[0] if get_origin(wanted) is not None else None
    if item is not None:
        items = yaml.safe_load(value) if isinstance(value, str) else value
        if not isinstance(items, list | tuple):
            raise TypeError(f"expected a list, got {value!r}")
        return [typed(each, item) for each in items]
    if wanted is str:
        return str(value)
    read = yaml.safe_load(value) if isinstance(value, str) else value
    if wanted is float and isinstance(read, int) and not isinstance(read, bool):
        return float(read)
    if type(read) is not wanted:
        raise TypeError(f"expected a value of type {getattr(wanted, '__name__', wanted)}, got {value!r}")
    return read


def _of_any_type(value: Any) -> Any:
    if isinstance(value, Text):
        try:
            value = yaml.safe_load(value) if value else ""
        except yaml.YAMLError:
            raise TypeError(
                f"the text {str(value)!r} is not YAML: ParameterValue(..., value_type=str) passes it as it is"
            ) from None
    if isinstance(value, list | tuple):
        return _uniform([_of_any_type(each) for each in value])
    if not isinstance(value, (*_SCALARS, bytes)):
        raise TypeError(
            f"expected a bool, a number, a text, or a list of these, got {value!r}; "
            "ParameterValue(..., value_type=str) passes a text as it is"
        )
    return value


def _uniform(values: Sequence[Any]) -> list[Any]:
    """A list of one type; a list with a float is one of floats, as upstream makes it."""
    kinds = {type(value) for value in values}
    if kinds == {int, float}:
        return [float(value) for value in values]
    if len(kinds) > 1:
        return [str(value) for value in values]
    return list(values)
