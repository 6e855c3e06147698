# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
r"""Texts with substitutions, as XML and YAML have them: `$(var name)`, `$(env HOME '/root')`, `\$`.

A text is anything up to `$(`. Within the parentheses are a name and arguments, with spaces between them. An
argument in quotes may have spaces and parentheses, and each may have substitutions of its own. `\` takes the
meaning from the character that follows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Final

from launch import substitutions
from launch._errors import LaunchError, Place
from launch.frontend.expose import exposed_substitutions, load_extensions
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

_MAX_DEPTH: Final = 50
_IN_NAMES: Final = "_-"


def parse_substitution(text: str) -> list[Substitution]:
    """Return the parts of a text that comes from no file. Raises LaunchError."""
    return parse(text, None)


def parse_if_substitutions(value: Any) -> Any:
    """Return what a value of an attribute has: a text is parsed, and each of a list. Raises LaunchError."""
    if isinstance(value, str):
        return parse_substitution(value)
    if isinstance(value, list):
        return [parse_if_substitutions(each) for each in value]
    return value


def parse(text: str, place: Place | None) -> list[Substitution]:
    """Return the parts of a text. Raises LaunchError."""
    reader = _Reader(text, place)
    parts = reader.parts(end="", depth=0)
    return parts or [TextSubstitution(text="")]


@dataclass
class _Reader:
    text: str
    place: Place | None
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
            return _make(name, arguments)
        except (ValueError, TypeError, RuntimeError) as error:
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

Text = list[Substitution]


def _var(name: Text, default: Text | None = None) -> Substitution:
    return substitutions.LaunchConfiguration(name, default=default)


def _env(name: Text, default: Text | None = None) -> Substitution:
    return substitutions.EnvironmentVariable(name, default_value=default)


def _command(command: Text, on_stderr: Text | None = None) -> Substitution:
    return substitutions.Command(command, on_stderr=on_stderr or "fail")


def _eval(expression: Text, modules: Text | None = None) -> Substitution:
    return substitutions.PythonExpression(expression, ["math"] if modules is None else [modules])  # type: ignore[list-item]  # each a text of its own


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
    "file-content": (substitutions.FileContent, 1, 1),
    "filename": (substitutions.ThisLaunchFile, 0, 0),
    "find-exec": (lambda name: substitutions.FindExecutable(name=name), 1, 1),
    "if": (substitutions.IfElseSubstitution, 2, 3),
    "launch_log_dir": (substitutions.LaunchLogDir, 0, 0),
    "log_dir": (substitutions.LaunchLogDir, 0, 0),
    "not": (substitutions.NotSubstitution, 1, 1),
    "not-equals": (substitutions.NotEqualsSubstitution, 2, 2),
    "or": (substitutions.OrSubstitution, 2, 2),
    "var": (_var, 1, 2),
}
"""The substitutions by name, with the fewest and the most arguments."""


def add_substitutions(known: Mapping[str, tuple[Callable[..., Substitution], int, int]]) -> None:
    """Add the substitutions of another package."""
    _KNOWN.update(known)


def _make(name: str, arguments: list[Any]) -> Substitution:
    """Return the substitution of a name. Raises ValueError."""
    if name not in _KNOWN:
        load_extensions()
    if name in exposed_substitutions:
        parse_arguments = exposed_substitutions[name]
        kind, options = parse_arguments(arguments)
        made: Substitution = kind(**options)
        return made
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
