# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Parameters as launch files write them, and what a node gets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from launch.launch_context import LaunchContext
from launch.substitution import Substitution
from launch.utilities import performed

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue, texts_of, typed


def evaluated(context: LaunchContext, given: Any) -> Path | dict[str, Any]:
    """Return the path of a file, or parameters by name: those of nested dicts have `.` in their names.

    Raises TypeError.
    """
    if isinstance(given, Mapping):
        return dict(_flat(context, given, ""))
    if isinstance(given, ParameterFile):
        return given.evaluate(context)
    if isinstance(given, Parameter):
        name, value = given.evaluate(context)
        return {name: value}
    if isinstance(given, str | Path | Substitution | list | tuple):
        return Path(performed(context, given))
    raise TypeError(f"expected parameters as a dict or the path of a file, got {given!r}")


def _flat(context: LaunchContext, given: Mapping[Any, Any], prefix: str) -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for key, value in given.items():
        name = prefix + performed(context, key)
        if isinstance(value, Mapping):
            found += _flat(context, value, f"{name}.")
            continue
        try:
            found.append((name, value_of(context, value)))
        except TypeError as error:
            raise TypeError(f"the parameter '{name}': {error}") from None
    return found


def value_of(context: LaunchContext, value: Any) -> Any:
    """Return the value of a parameter. Raises TypeError."""
    return (
        value.evaluate(context)
        if isinstance(value, ParameterValue)
        else typed(texts_of(context, value), None)
    )
