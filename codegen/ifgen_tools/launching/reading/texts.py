r"""Texts with substitutions, as XML and YAML have them: `$(var name)`, `$(env HOME '/root')`, `\$`.

A text is anything up to `$(`. Within the parentheses are a name and arguments, with spaces between them. An
argument in quotes may have spaces and parentheses, and each may have substitutions of its own. `\` takes the
meaning from the character that follows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

from ifgen_tools.launching.errors import LaunchError, Place
from ifgen_tools.launching.reading.substitutions import make

_MAX_DEPTH: Final = 50
_IN_NAMES: Final = "_-"


def parse(text: str, place: Place) -> list[Substitution]:
    """Return the parts of a text. Raises LaunchError."""
    reader = _Reader(text, place)
    parts = reader.parts(end="", depth=0)
    return parts or [TextSubstitution(text="")]


@dataclass
class _Reader:
    text: str
    place: Place
    at: int = 0

    def parts(self, end: str, depth: int) -> list[Substitution]:
        """Read up to one of these characters, or to the end of the text."""
        found: list[Substitution] = []
        plain = ""
        while self.at < len(self.text) and self.text[self.at] not in end:
            character = self.text[self.at]
            if character == "$" and self.text.startswith("$(", self.at):
                if plain:
                    found.append(TextSubstitution(text=plain))
                    plain = ""
                found.append(self.substitution(depth + 1))
                continue
            if character == "\\" and self.at + 1 < len(self.text):
                self.at += 1
            elif character == "$":
                raise self.error("a '$' stands before no '('", r"write '\$' for the character itself")
            elif end == _ENDS and character in "('\"":
                raise self.error(f"an argument cannot contain {character!r}", "put the argument in quotes")
            plain += self.text[self.at]
            self.at += 1
        if plain:
            found.append(TextSubstitution(text=plain))
        return found

    def substitution(self, depth: int) -> Substitution:
        begin = self.at
        if depth > _MAX_DEPTH:
            raise self.error(f"more than {_MAX_DEPTH} substitutions within each other")
        self.at += 2
        name_at = self.at
        while self.at < len(self.text) and (self.text[self.at].isalnum() or self.text[self.at] in _IN_NAMES):
            self.at += 1
        name = self.text[name_at : self.at]
        if not name:
            raise self.error("a substitution has no name", "write it as $(var NAME)")
        arguments: list[list[Substitution]] = []
        while True:
            spaces = self.at
            while self.at < len(self.text) and self.text[self.at].isspace():
                self.at += 1
            if self.at >= len(self.text):
                self.at = begin
                raise self.error(f"the substitution '$({name}' has no ')' at its end")
            if self.text[self.at] == ")":
                self.at += 1
                break
            if spaces == self.at:
                raise self.error(f"expected a space or ')' in the substitution '$({name}'")
            arguments.append(self.argument(depth))
        try:
            return make(name, arguments)
        except ValueError as error:
            raise LaunchError(str(error), self.place) from None

    def argument(self, depth: int) -> list[Substitution]:
        quote = self.text[self.at]
        if quote not in "'\"":
            return self.parts(_ENDS, depth)
        begin = self.at
        self.at += 1
        parts = self.parts(quote, depth)
        if self.at >= len(self.text):
            self.at = begin
            raise self.error(f"the argument has no {quote} at its end")
        self.at += 1
        return parts or [TextSubstitution(text="")]

    def error(self, message: str, help: str = "") -> LaunchError:
        shown = self.text if len(self.text) <= 60 else f"{self.text[:57]}..."
        return LaunchError(f"{message}, at character {self.at + 1} of {shown!r}", self.place, help)


_ENDS: Final = " \t\n\r)"
"""The characters that end an argument without quotes."""
