"""The state of a run of CMake files: its variables, its folder, the current command, and its budget."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Source, Span
from ifgen.reading.cmake import values
from ifgen.reading.cmake.text import Argument, Command
from ifgen.reading.cmake.values import EMPTY, Doubt, Unclosed, Value, elements, expanded

_BUDGET: Final = 2_000_000
"""Characters that a run may handle; a package of 500 interfaces needs a tenth of that."""

_STEPS_A_CHARACTER: Final = 50
"""The steps of a regular expression that cost as much as a character."""

_VARIABLE: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_.+-]*")

# A build by colcon on the platform that ROS releases are made for.
_BUILT_IN: Final = {
    **dict.fromkeys(("CMAKE_COMPILER_IS_GNUCC", "CMAKE_COMPILER_IS_GNUCXX", "CMAKE_HOST_UNIX"), "1"),
    **dict.fromkeys(("LINUX", "UNIX"), "1"),
    **dict.fromkeys(("CMAKE_CXX_COMPILER_ID", "CMAKE_C_COMPILER_ID"), "GNU"),
    **dict.fromkeys(("CMAKE_HOST_SYSTEM_NAME", "CMAKE_SYSTEM_NAME"), "Linux"),
    "BUILD_TESTING": "ON",
    "CMAKE_VERSION": "3.28.3",
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
        self._imported = imported
        self._doubt = doubt
        self.cached: dict[str, Value] = {}
        self.packages: set[str] = set()
        self.all_are_found: Doubt | None = None
        self.assumption: Doubt | None = None

    def get(self, name: str) -> Value | None:
        """The value of a variable; None if it is not defined."""
        for scope, _ in reversed(self._scopes):
            if name in scope:
                return scope[name]
        if name in self.cached:
            return self.cached[name]
        if name in _BUILT_IN:
            return Value(_BUILT_IN[name])
        if name in _BUILD_FOLDERS:
            return self._lost(f"only a build knows {name}")
        if self.all_are_found is not None and name.endswith("_FOUND"):
            return Value("1", self.all_are_found)
        # `NAME_FOUND`, `NAME_MSG_FILES` and the like come out of the configuration of a package.
        for end in (at for at, character in enumerate(name) if character == "_"):
            if name[:end] in self.packages:
                return self._imported(name[:end], name) or self._lost(
                    f"{name} comes from package {name[:end]}"
                )
        return None

    def value(self, name: str) -> Value:
        """The value of a variable; empty if it is not defined."""
        return self.get(name) or EMPTY

    def referenced(self, where: str, name: str) -> Value:
        """The value of `${name}`, `$ENV{name}` or `$CACHE{name}`."""
        if where == "CACHE":
            return self.cached.get(name, EMPTY)
        if not where:
            return self.value(name)
        if name not in ENVIRONMENT:
            return Value("", self._doubt(f"${where}{{{name}}} is not known"))
        return Value((os.environ.get(name) if name == "ROS_DISTRO" else None) or ENVIRONMENT[name])

    def set(self, name: str, value: Value | None, parent: bool = False) -> None:
        """Give a variable a value, or none: in this scope, or in the one around it."""
        if value is not None and value.doubt is None and self.assumption is not None:
            value = Value(value.text, self.assumption)
        scopes = [scope for scope, of_macro in self._scopes if not of_macro]
        scopes[-2 if parent and len(scopes) > 1 else -1][name] = value

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

    def _lost(self, reason: str) -> Value:
        return Value("", replace(self._doubt(reason), lost=True))


class ExhaustedError(Exception):
    """The file does more than any list of interfaces needs."""


class State:
    """A run, as the commands see it, in a folder; `imported` has the variables that packages bring."""

    def __init__(self, folder: Path, imported: Callable[[str, str], Value | None]) -> None:
        self.folder = folder
        self.variables = Variables(imported, self.doubt)
        for name in ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR"):
            self.variables.set(name, Value(folder.as_posix()))
        self.span = Span(Source(folder, ""), 0, 0)
        """The place of the command at hand: its name."""
        self._budget = _BUDGET

    def enter(self, source: Source, command: Command) -> list[Value]:
        """The arguments of a command, which is the one at hand from now on."""
        self.span = Span(source, command.start, command.start + len(command.name))
        self.spend(20)
        return self.words(command)

    def doubt(self, reason: str, lost: bool = False) -> Doubt:
        """A doubt that the command at hand brings."""
        return Doubt(reason, self.span, lost)

    def spend(self, characters: int) -> None:
        """Pay for work. Raises ExhaustedError once there is nothing left."""
        self._budget -= characters
        if self._budget < 0:
            raise ExhaustedError

    def regex(self, pattern: str, subjects: Sequence[str]) -> re.Pattern[str]:
        """A regular expression to search texts with, paid for. Raises Unsure."""
        compiled, steps = values.regex(pattern, subjects)
        self.spend(min(steps, _BUDGET * _STEPS_A_CHARACTER) // _STEPS_A_CHARACTER)
        return compiled

    def suspect(self, words: Iterable[Value], doubt: Doubt) -> None:
        """Whatever variables the words name are in doubt from now on."""
        for word in words:
            if not word.quoted and _VARIABLE.fullmatch(word.text):
                self.variables.suspect(word.text, doubt)

    def words(self, command: Command) -> list[Value]:
        """Arguments with their references evaluated; one without quotes may be any number of words."""
        return [word for argument in command.arguments for word in self._words(argument)]

    def _words(self, argument: Argument) -> Iterable[Value]:
        if argument.quoting == "brackets":
            return [Value(argument.text, quoted=True)]
        try:
            text, doubt, _ = expanded(argument.text, self.variables.referenced)
        except Unclosed:
            text, doubt = "", self.doubt("the references in it cannot be told apart", lost=True)
        self.spend(len(text))
        if argument.quoting == "quotes":
            return [Value(text, doubt, quoted=True)]
        # One for an unknown list, so that the doubt is not lost.
        parts = elements(text) or ([] if doubt is None else [""])
        return (Value(part, doubt) for part in parts)
