# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Names of nodes, and what a node gets of the parameters that launch files write."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from launch.launch_context import LaunchContext
from launch.substitution import Substitution
from launch.utilities import performed

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue, texts_of, typed

_NAMESPACE = re.compile(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def prefix_namespace(outer: str | None, inner: str | None) -> str | None:
    """Return a namespace within another one; an absolute one stays as it is, and None stands for none."""
    if inner is None or outer is None:
        return outer if inner is None else inner
    if inner.startswith("/") or not outer:
        return inner
    return f"{outer.rstrip('/')}/{inner}" if inner else outer


def make_namespace_absolute(namespace: str) -> str:
    """Return a namespace with a `/` in front, and none at its end. Raises RuntimeError."""
    found = "/" + namespace.strip("/")
    if not _NAMESPACE.fullmatch(found):
        raise RuntimeError(
            f"'{namespace}' is no namespace: expected names of letters, digits and _, with / between them"
        )
    return found


def checked_name(name: str) -> str:
    """Return the name of a node. Raises RuntimeError."""
    if not _NAME.fullmatch(name):
        raise RuntimeError(f"'{name}' is no name of a node: expected letters, digits and _, no digit first")
    return name


def evaluate_one(context: LaunchContext, given: Any) -> Path | dict[str, Any]:
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
