# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Parameters of nodes: values with their types, files, and single ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, get_args, get_origin

from ifgen_runtime.parameters import parameter_yaml
from launch._errors import explained
from launch.conditions import evaluate_condition_expression
from launch.launch_context import LaunchContext
from launch.logging import get_logger
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions, performed

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
        if not evaluate_condition_expression(context, self.allow_substs):
            return Path(path)
        file = context.files.text(_filled(path, context))
        entries: dict[str, parameter_yaml.Entry] = {}
        try:
            parameter_yaml.read_file(file, lambda node: entries.setdefault(node, {}))
        except parameter_yaml.ParameterYamlError as error:
            raise RuntimeError(
                f"the parameter file '{path}' cannot be read after its substitutions: {error.reason}"
            ) from None
        return Path(file)


class Parameter:
    """One parameter: its name, and its value as in ParameterValue."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.value = ParameterValue(value, value_type=value_type)

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return the name and the value. Raises TypeError."""
        return perform_substitutions(context, self.name), self.value.evaluate(context)


PASS_AS_TEXT = "ParameterValue(..., value_type=str) passes a text as it is"
"""Advice for a launch file in Python. `ifgen launch` replaces it for files in XML and YAML."""


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
    """Return a value of the type that is wanted; None: of the one that nodes read in a Text.

    Raises TypeError.
    """
    if wanted is None:
        return _of_any_type(value)
    item = get_args(wanted)[0] if get_origin(wanted) is not None else None
    if item is not None:
        if isinstance(value, str):
            return [_element(text, read, item) for text, read in _read(value, parameter_yaml.read_elements)]
        if not isinstance(value, list | tuple):
            raise TypeError(f"expected a list, got {value!r}")
        return [typed(each, item) for each in value]
    if wanted is str:
        return str(value)
    return _element(value, _read(value, parameter_yaml.value_of) if isinstance(value, str) else value, wanted)


def _read(text: str, reader: Callable[[str], Any]) -> Any:
    """Read a text as nodes do. Raises TypeError."""
    try:
        return reader(text)
    except parameter_yaml.ParameterYamlError as error:
        raise TypeError(f"the text {text!r} is no value of a parameter: {error.reason}") from None


def _value(text: str) -> Any:
    """A value, or the elements of a list, which may have several types."""
    if text.lstrip().startswith("["):
        return [value for _, value in parameter_yaml.read_elements(text)]
    return parameter_yaml.value_of(text)


def _element(value: Any, read: Any, wanted: type) -> Any:
    """Return what was read in a value, in the type that is wanted. Raises TypeError."""
    if wanted is str:
        return str(value)
    if wanted is float and isinstance(read, int) and not isinstance(read, bool):
        return float(read)
    if type(read) is not wanted:
        raise TypeError(f"expected a value of type {getattr(wanted, '__name__', wanted)}, got {value!r}")
    return read


def _of_any_type(value: Any) -> Any:
    if isinstance(value, Text):
        try:
            value = _read(value, _value) if value else ""
        except TypeError as error:
            raise TypeError(f"{error}; {PASS_AS_TEXT}") from None
    if isinstance(value, list | tuple):
        return _uniform([_of_any_type(each) for each in value])
    if not isinstance(value, (*_SCALARS, bytes)):
        raise TypeError(
            f"expected a bool, a number, a text, or a list of these, got {value!r}; {PASS_AS_TEXT}"
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


def _filled(path: str, context: LaunchContext) -> str:
    """Return the text of a file with its substitutions performed. Raises RuntimeError."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise RuntimeError(f"cannot read the parameter file '{path}': {error}") from None
    # It imports all actions, and with them this module.
    from launch.frontend.parse_substitution import parse

    filled: list[str] = []
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        place = (path, number)
        try:
            filled.append(perform_substitutions(context, parse(line, place)) if "$(" in line else line)
        except Exception as error:
            raise explained(error, place) from error
    return "".join(filled)


def written(context: LaunchContext, parameters: Mapping[str, Any], node: str) -> str:
    """Write parameters of a node to a file, and return its path. Raises RuntimeError."""
    for name, value in parameters.items():
        if isinstance(value, bytes):
            raise RuntimeError(f"the parameter '{name}' is bytes, which no parameter file can hold")
        if parameter_yaml.is_beyond_files(value):
            get_logger().warning(
                f"the parameter '{name}' is an empty list, which no parameter file can hold: "
                "the node keeps its default value"
            )
    return context.files.text(parameter_yaml.file_text(node, parameters))
