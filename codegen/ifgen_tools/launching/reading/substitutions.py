"""The substitutions that XML and YAML can name."""

from __future__ import annotations

from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, Final

from launch import substitutions
from launch.substitution import Substitution
from launch_ros import substitutions as of_ros

Text = list[Substitution]


def _var(name: Text, default: Text | None = None) -> Substitution:
    return substitutions.LaunchConfiguration(name, default=default)


def _env(name: Text, default: Text | None = None) -> Substitution:
    return substitutions.EnvironmentVariable(name, default_value=default)


def _command(command: Text, on_stderr: Text | None = None) -> Substitution:
    return substitutions.Command(command, on_stderr=on_stderr or "fail")


def _eval(expression: Text, modules: Text | None = None) -> Substitution:
    return substitutions.PythonExpression(expression, ["math"] if modules is None else [modules])  # type: ignore[list-item]  # each a text of its own


def _in_package(executable: Text, package: Text) -> Substitution:
    return of_ros.ExecutableInPackage(executable=executable, package=package)


def _parameter(name: Text, default: Text | None = None) -> Substitution:
    return of_ros.Parameter(name, default=default)


_MANY: Final = 1000
_KNOWN: Final[dict[str, tuple[Callable[..., Substitution], int, int]]] = {
    "all": (substitutions.AllSubstitution, 1, _MANY),
    "and": (substitutions.AndSubstitution, 2, 2),
    "anon": (substitutions.AnonName, 1, 1),
    "any": (substitutions.AnySubstitution, 1, _MANY),
    "command": (_command, 1, 2),
    "dirname": (substitutions.ThisLaunchFileDir, 0, 0),
    "env": (_env, 1, 2),
    "equals": (substitutions.EqualsSubstitution, 2, 2),
    "eval": (_eval, 1, 2),
    "exec-in-pkg": (_in_package, 2, 2),
    "file-content": (substitutions.FileContent, 1, 1),
    "filename": (substitutions.ThisLaunchFile, 0, 0),
    "find-exec": (lambda name: substitutions.FindExecutable(name=name), 1, 1),
    "find-pkg-prefix": (of_ros.FindPackagePrefix, 1, 1),
    "find-pkg-share": (of_ros.FindPackageShare, 1, 1),
    "if": (substitutions.IfElseSubstitution, 2, 3),
    "launch_log_dir": (substitutions.LaunchLogDir, 0, 0),
    "log_dir": (substitutions.LaunchLogDir, 0, 0),
    "not": (substitutions.NotSubstitution, 1, 1),
    "not-equals": (substitutions.NotEqualsSubstitution, 2, 2),
    "or": (substitutions.OrSubstitution, 2, 2),
    "param": (_parameter, 1, 2),
    "var": (_var, 1, 2),
}
"""The substitutions by name, with the fewest and the most arguments."""


def make(name: str, arguments: list[Any]) -> Substitution:
    """Return the substitution of a name. Raises ValueError."""
    if name not in _KNOWN:
        close = get_close_matches(name, _KNOWN, n=1)
        meant = f"did you mean '{close[0]}'?" if close else f"there are {', '.join(_KNOWN)}"
        raise ValueError(f"`ifgen launch` has no substitution '$({name})': {meant}")
    build, fewest, most = _KNOWN[name]
    if not fewest <= len(arguments) <= most:
        wanted = (
            str(fewest) if fewest == most else f"{fewest} to {most}" if most < _MANY else f"{fewest} or more"
        )
        raise ValueError(f"the substitution '$({name})' takes {wanted} arguments, got {len(arguments)}")
    return build(*arguments)
