"""The state of a run of a CMake file: its variables, its folder, the current command, and its budget."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Source, Span
from ifgen.reading.cmake import patterns
from ifgen.reading.cmake.text import Argument, Command
from ifgen.reading.cmake.values import Doubt, Unclosed, Value, elements, expanded
from ifgen.reading.cmake.variables import Variables
from ifgen.reading.cmake.words import Word

_BUDGET: Final = 2_000_000
"""Characters that a run may handle; a package of 500 interfaces needs a tenth of that."""

_STEPS_A_CHARACTER: Final = 50
"""The steps of a regular expression that cost as much as a character."""


class ExhaustedError(Exception):
    """The file does more than any list of interfaces needs."""


class State:
    """A run, as the commands see it, in a folder; `imported` has the variables that packages bring."""

    def __init__(self, folder: Path, imported: Callable[[str, str], Value | None]) -> None:
        self.folder = folder
        self.variables = Variables(imported, self.doubt)
        for name in ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR"):
            self.variables.set(name, Value(folder.as_posix()))
        self._source = Source(folder, "")
        self._command: Command | None = None
        self._budget = _BUDGET

    def at(self, source: Source, command: Command) -> None:
        """Note which command it is at."""
        self._source, self._command = source, command
        self.spend(20)

    @property
    def span(self) -> Span:
        """The place of the command at hand: its name."""
        start = self._command.start if self._command else 0
        return Span(self._source, start, start + len(self._command.name if self._command else ""))

    def doubt(self, reason: str, lost: bool = False) -> Doubt:
        """A doubt that the command at hand brings."""
        return Doubt(reason, self.span, lost)

    def spend(self, characters: int) -> None:
        """Pay for work. Raises ExhaustedError once there is nothing left."""
        self._budget -= characters
        if self._budget < 0:
            raise ExhaustedError

    def regex(self, pattern: str, subjects: Sequence[str]) -> re.Pattern[str]:
        """A regular expression to search texts with, paid for. Raises patterns.Unsure."""
        compiled, steps = patterns.regex(pattern, subjects)
        self.spend(min(steps, _BUDGET * _STEPS_A_CHARACTER) // _STEPS_A_CHARACTER)
        return compiled

    def words(self, arguments: Sequence[Argument]) -> list[Word]:
        """Arguments with their references evaluated; one without quotes may be any number of words."""
        found: list[Word] = []
        for argument in arguments:
            if argument.quoting == "brackets":
                found.append(Word(argument.text, quoted=True))
                continue
            value = self._expanded(argument.text)
            self.spend(len(value.text))
            if argument.quoting == "quotes":
                found.append(Word(value.text, True, value.doubt))
            else:
                parts = elements(value.text)
                if not parts and value.doubt is not None:
                    parts = [""]  # so that the doubt is not lost
                found += (Word(part, False, value.doubt) for part in parts)
        return found

    def _expanded(self, text: str) -> Value:
        try:
            return expanded(text, self.variables.referenced)
        except Unclosed:
            return Value("", self.doubt("the references in it cannot be told apart", lost=True))
