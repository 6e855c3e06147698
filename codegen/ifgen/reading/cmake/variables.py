"""The variables of a CMake run: scopes, what CMake and ROS define themselves, and what only a build knows."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from typing import Final

from ifgen.reading.cmake.values import EMPTY, Doubt, Value

# A build by colcon on the platform that ROS releases are made for.
_BUILT_IN: Final = {
    "BUILD_TESTING": "ON",
    "CMAKE_COMPILER_IS_GNUCC": "1",
    "CMAKE_COMPILER_IS_GNUCXX": "1",
    "CMAKE_CXX_COMPILER_ID": "GNU",
    "CMAKE_C_COMPILER_ID": "GNU",
    "CMAKE_HOST_SYSTEM_NAME": "Linux",
    "CMAKE_HOST_UNIX": "1",
    "CMAKE_SYSTEM_NAME": "Linux",
    "CMAKE_VERSION": "3.28.3",
    "LINUX": "1",
    "UNIX": "1",
}
ENVIRONMENT: Final = {"ROS_DISTRO": "jazzy", "ROS_PYTHON_VERSION": "3", "ROS_VERSION": "2"}
"""The variables that a sourced ROS 2 sets, with the distribution that is sourced here, if any."""

_BUILD_FOLDERS: Final = frozenset(
    ("CMAKE_BINARY_DIR", "CMAKE_CURRENT_BINARY_DIR", "CMAKE_INSTALL_PREFIX", "PROJECT_BINARY_DIR")
)


class Variables:
    """The variables so far; `imported` finds a variable whose name starts with that of a package.

    `doubt` makes a doubt of a reason, at the place of the command that reads a variable.
    """

    def __init__(self, imported: Callable[[str, str], Value | None], doubt: Callable[[str], Doubt]) -> None:
        # Each with True if it belongs to a macro, whose parameters can be read inside, but not set.
        self._scopes: list[tuple[dict[str, Value | None], bool]] = [({}, False)]
        self._cache: dict[str, Value] = {}
        self._imported = imported
        self._doubt = doubt
        self.packages: set[str] = set()
        self.all_are_found: Doubt | None = None
        self.assumption: Doubt | None = None

    def get(self, name: str) -> Value | None:
        """The value of a variable; None if it is not defined."""
        for scope, _ in reversed(self._scopes):
            if name in scope:
                return scope[name]
        if name in self._cache:
            return self._cache[name]
        if name in _BUILT_IN:
            return Value(_BUILT_IN[name])
        if name in _BUILD_FOLDERS:
            return Value("", self._lost(f"only a build knows {name}"))
        if self.all_are_found is not None and name.endswith("_FOUND"):
            return Value("1", self.all_are_found)
        # `NAME_FOUND`, `NAME_MSG_FILES` and the like come out of the configuration of a package.
        for end in (at for at, character in enumerate(name) if character == "_"):
            if name[:end] in self.packages:
                found = self._imported(name[:end], name)
                return found or Value("", self._lost(f"{name} comes from package {name[:end]}"))
        return None

    def referenced(self, where: str, name: str) -> Value:
        """The value of `${name}`, `$ENV{name}` or `$CACHE{name}`."""
        if where == "ENV":
            text = ENVIRONMENT.get(name)
            if name == "ROS_DISTRO":
                text = os.environ.get(name) or text
            return Value("", self._doubt(f"${where}{{{name}}} is not known")) if text is None else Value(text)
        if where == "CACHE":
            return self._cache.get(name, EMPTY)
        return self.get(name) or EMPTY

    def set(self, name: str, value: Value | None, parent: bool = False) -> None:
        """Give a variable a value, or none: in this scope, or in the one around it."""
        if value is not None and value.doubt is None and self.assumption is not None:
            value = Value(value.text, self.assumption)
        scopes = [scope for scope, of_macro in self._scopes if not of_macro]
        scopes[-2 if parent and len(scopes) > 1 else -1][name] = value

    def cache(self, name: str, value: Value, force: bool = False) -> None:
        """Give a cached variable a value, unless it has one."""
        if force or name not in self._cache:
            self._cache[name] = value

    def suspect(self, name: str, doubt: Doubt) -> None:
        """Note that a variable may have another value than it has."""
        value = self.get(name)
        if value is None or value.doubt is None or (doubt.lost and not value.doubt.lost):
            self.set(name, Value(value.text if value else "", doubt))

    @contextmanager
    def scope(self, parameters: Mapping[str, Value], of_macro: bool = False) -> Generator[None]:
        """Within, there are parameters; what a function sets is forgotten afterwards."""
        self._scopes.append((dict(parameters), of_macro))
        try:
            yield
        finally:
            self._scopes.pop()

    def _lost(self, reason: str) -> Doubt:
        doubt = self._doubt(reason)
        return Doubt(doubt.reason, doubt.span, lost=True)
