"""Follows a CMake file as far as it decides what `rosidl_generate_interfaces` is called with; runs nothing.

What only a build knows (the answer of another program, what a package that is looked for defines) leaves a
doubt, which stays with every value that comes of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from ifgen.diagnostics import Source, Span
from ifgen.reading import storage
from ifgen.reading.cmake.calls import Followed
from ifgen.reading.cmake.interpreter import Interpreter
from ifgen.reading.cmake.program import parsed
from ifgen.reading.cmake.state import ExhaustedError, State
from ifgen.reading.cmake.text import SyntaxProblem
from ifgen.reading.cmake.values import Doubt, Value
from ifgen.reading.cmake.variables import Variables


def follow(source: Source, folder: Path, shares: Sequence[Path]) -> Followed:
    """Follow the CMakeLists.txt of a folder and what it includes. Packages are installed in `shares`."""
    state = State(folder, _Extras(shares).variable)
    interpreter = Interpreter(state)
    try:
        interpreter.run(parsed(source, state.spend))
    except SyntaxProblem as error:
        doubt = Doubt(str(error), Span(source, error.offset, error.offset + 1), True)
        return Followed((), (source,), doubt)
    except ExhaustedError:
        return Followed((), (source,), Doubt("it runs too many commands", Span(source, 0, 0), True))
    return Followed(tuple(interpreter.calls), (source, *interpreter.included), interpreter.unsure)


class _Extras:
    """The variables that installed packages bring in CMake files of their own; followed when asked."""

    def __init__(self, shares: Sequence[Path]) -> None:
        self._shares = shares
        self._known: dict[str, Variables | None] = {}

    def variable(self, package: str, name: str) -> Value | None:
        """The value of a variable that a package brings, if it does."""
        if package not in self._known:
            self._known[package] = None
            paths = (share / package / "cmake" / f"{package}-extras.cmake" for share in self._shares)
            path = next((path for path in paths if storage.is_file(path)), None)
            if path is not None:
                self._known[package] = _extras_in(path, package)
        extras = self._known[package]
        return extras.get(name) if extras else None


def _extras_in(path: Path, package: str) -> Variables:
    state = State(path.parent, lambda package, name: None)
    state.variables.set(f"{package}_DIR", Value(path.parent.as_posix()))
    with suppress(ExhaustedError):
        Interpreter(state).follow(path)
    return state.variables
