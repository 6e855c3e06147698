"""The names of parameters that a node lists."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import ListParametersResult

from rclpy.parameter import PARAMETER_SEPARATOR_STRING


def check_strings(names: list[Any]) -> None:
    """Raise TypeError unless all names are strings."""
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")


def list_names(names: list[str], prefixes: Any, depth: Any) -> ListParametersResult:
    """Return the names below the prefixes, at most `depth` levels deep (0: all), and their prefixes.

    Raises TypeError and ValueError for prefixes that are no list of strings, or a depth that makes no sense.
    """
    if not isinstance(prefixes, list):
        raise TypeError("The prefixes argument must be a list")
    if not all(isinstance(prefix, str) for prefix in prefixes):
        raise TypeError("All prefixes must be instances of type str")
    if not isinstance(depth, int):
        raise TypeError("The depth must be instance of type int")
    if depth < 0:
        raise ValueError("The depth must be greater than or equal to zero")
    listed = [name for name in names if _is_listed(name, prefixes, depth)]
    parents = [name.rpartition(PARAMETER_SEPARATOR_STRING)[0] for name in listed]
    return ListParametersResult(
        names=listed, prefixes=list(dict.fromkeys(parent for parent in parents if parent))
    )


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    """Whether a name is one of the prefixes or lies below one, and not too deep below.

    Depth 0 is no limit.
    """

    def is_shallow(rest: str) -> bool:
        return depth == 0 or rest.count(PARAMETER_SEPARATOR_STRING) < depth

    if not prefixes:
        return is_shallow(name)
    return any(
        name == prefix
        or (name.startswith(prefix + PARAMETER_SEPARATOR_STRING) and is_shallow(name[len(prefix) + 1 :]))
        for prefix in prefixes
    )
