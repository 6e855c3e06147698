# Values of parameters are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnnecessaryIsInstance=false
"""Names of nodes, and what a node gets of the parameters that launch files write."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.launch_context import LaunchContext
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, performed

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue, texts_of, typed

_NAMESPACE = re.compile(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_PAIR = 2


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


def is_root_namespace(namespace: str) -> bool:
    """Whether a namespace is that of the root."""
    return namespace == "/"


def is_namespace_absolute(namespace: str) -> bool:
    """Whether a namespace begins at the root."""
    return namespace.startswith("/")


_NODE_NAMES = "unique_ros_node_names"


def add_node_name(context: LaunchContext, node_name: str, count: int = 1) -> int:
    """Count nodes of a full name that are started; returns their number so far."""
    names = context.get_globals_as_dict().get(_NODE_NAMES, {})
    names = {**names, node_name: names.get(node_name, 0) + count}
    context.extend_globals({_NODE_NAMES: names})
    return int(names[node_name])


def get_node_name_count(context: LaunchContext, node_name: str) -> int:
    """Return how many nodes of a full name were noted."""
    return int(context.get_globals_as_dict().get(_NODE_NAMES, {}).get(node_name, 0))


def normalize_remap_rule(remap_rule: Any) -> tuple[list[Substitution], list[Substitution]]:
    """Return a pair (from, to) with each part as a list of substitutions. Raises TypeError."""
    if isinstance(remap_rule, str) or not isinstance(remap_rule, Sequence) or len(remap_rule) != _PAIR:
        raise TypeError(f"a remapping is a pair (from, to), got {remap_rule!r}")
    old, new = (normalize_to_list_of_substitutions(each) for each in remap_rule)
    return old, new


def normalize_remap_rules(remap_rules: Any) -> Iterator[tuple[list[Substitution], list[Substitution]]]:
    """Yield each pair as `normalize_remap_rule` returns it. Raises TypeError."""
    if isinstance(remap_rules, Mapping):
        raise TypeError(f"remappings must be a list of pairs (from, to), got {remap_rules!r}")
    yield from map(normalize_remap_rule, remap_rules)


def normalize_parameters(parameters: Sequence[Any] | None) -> list[Any]:
    """Return parameters of a node: files, Parameter objects, and dicts without others inside.

    Raises TypeError.
    """
    if parameters is None or isinstance(parameters, str | Mapping) or not isinstance(parameters, Sequence):
        raise TypeError(f"parameters must be a list of dicts and files, got {parameters!r}")
    return [_normalized(each) for each in parameters]


def _normalized(given: Any) -> Any:
    if isinstance(given, Mapping):
        return normalize_parameter_dict(given)
    if isinstance(given, Parameter | ParameterFile):
        return given
    if isinstance(given, str | Path | Substitution | list | tuple):
        return ParameterFile(given)
    raise TypeError(f"expected parameters as a dict or the path of a file, got {given!r}")


def normalize_parameter_dict(
    parameters: Mapping[Any, Any], *, _prefix: Sequence[Any] = ()
) -> dict[tuple[Substitution, ...], Any]:
    """Return parameters by name, as substitutions: those of nested dicts have `.` in their names."""
    found: dict[tuple[Substitution, ...], Any] = {}
    for key, value in parameters.items():
        name = [*_prefix, *normalize_to_list_of_substitutions(key)]
        if isinstance(value, Mapping):
            inside = [*name, *normalize_to_list_of_substitutions(".")]
            found |= normalize_parameter_dict(value, _prefix=inside)
        else:
            found[tuple(name)] = value
    return found


def evaluate_parameter_dict(context: LaunchContext, parameters: Mapping[Any, Any]) -> dict[str, Any]:
    """Return the values of parameters by name; lists are tuples. Raises TypeError."""
    values = dict(_flat(context, parameters, ""))
    return {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}


def evaluate_parameters(context: LaunchContext, parameters: Sequence[Any]) -> tuple[Any, ...]:
    """Return what `normalize_parameters` returned, with paths and values in place of substitutions."""
    return tuple(
        evaluate_parameter_dict(context, each) if isinstance(each, Mapping) else evaluate_one(context, each)
        for each in parameters
    )


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
