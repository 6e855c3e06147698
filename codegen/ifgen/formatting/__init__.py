"""One style for the files that people write: spaces and blank lines change, never what a file means.

Order, types, names, values and comments stay. Whether a comment stands in the first column stays too, because
that decides whose it is.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.formatting import definitions, nested, yaml_text

Formatter = Callable[[Source], str]
"""From a valid file with plain line ends to its text in our style; InputError if the file is not valid."""
Meaning = Callable[[Source], object]
"""From a file to a value that formatting must not change: files that mean the same have equal ones."""

_STYLES: Final[dict[str, tuple[Formatter, Meaning]]] = {
    ".msg": (definitions.formatted, definitions.meaning),
    ".srv": (definitions.formatted, definitions.meaning),
    ".action": (definitions.formatted, definitions.meaning),
    ".idl": (nested.formatted_idl, nested.idl_meaning),
    ".nodl.json": (nested.formatted_json, nested.json_meaning),
    ".nodl.yaml": (yaml_text.formatted, yaml_text.meaning),
    ".nodl.yml": (yaml_text.formatted, yaml_text.meaning),
}
EXTENSIONS: Final = tuple(_STYLES)
"""The ends of the names of files that have a style."""


def has_style(path: Path) -> bool:
    """Whether files of this name have a style."""
    return path.name.endswith(EXTENSIONS)


def formatted(source: Source) -> str:
    """The text of a file in our style, with plain line ends.

    The file's name says which kind it is. Raises InputError if the file has syntax errors: they come first.
    """
    formatter, meaning = next(styles for end, styles in _STYLES.items() if source.path.name.endswith(end))
    text = formatter(source)
    if text != source.text and meaning(Source(source.path, text)) != meaning(source):
        raise InputError([_unsafe(source)])
    return text


def _unsafe(source: Source) -> Diagnostic:
    """A mistake of ours: better told than written."""
    return Diagnostic(
        rule="unsafe-format",
        message="the file would mean something else after formatting, so it stays as it is",
        primary=Label(Span(source, 0, 0)),
        help="this is a mistake of ifgen: please report it with the file",
    )
