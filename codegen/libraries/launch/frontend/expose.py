"""The names of actions and substitutions in XML and YAML, as packages of users give them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import metadata
from typing import Any, Final, TypeVar

from launch.action import Action
from launch.substitution import Substitution

_ActionType = TypeVar("_ActionType", bound=type[Action])
_SubstitutionType = TypeVar("_SubstitutionType", bound=type[Substitution])

exposed_actions: Final[dict[str, Any]] = {}
"""The classes by the name of their elements."""
exposed_substitutions: Final[dict[str, Any]] = {}
"""The functions that parse arguments, by the names of their substitutions."""


@cache
def load_extensions() -> None:
    """Import the packages that have actions and substitutions of their own, once."""
    from launch_ros._frontend import register  # it imports this module

    register()
    for point in metadata.entry_points(group="launch.frontend.launch_extension"):
        if point.value not in {"launch", "launch_ros"}:
            point.load()


def expose_action(name: str) -> Callable[[_ActionType], _ActionType]:
    """Return a decorator that gives an action a name; its method `parse` reads the element."""

    def expose(action: _ActionType) -> _ActionType:
        exposed_actions[name] = action
        return action

    return expose


def expose_substitution(name: str) -> Callable[[_SubstitutionType], _SubstitutionType]:
    """Return a decorator that gives a substitution a name; its method `parse` takes the arguments."""

    def expose(substitution: _SubstitutionType) -> _SubstitutionType:
        exposed_substitutions[name] = substitution.parse
        return substitution

    return expose
