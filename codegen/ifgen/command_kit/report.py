"""The formats of diagnostics: for people (in the manner of rustc), as JSON, and as annotations on GitHub.

Everything here turns values into text; `main.py` prints it.
"""

from __future__ import annotations

import json
import textwrap
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ifgen.diagnostics import Diagnostic, Label, Source, printable, shown_character, shown_path, shown_source

if TYPE_CHECKING:
    from rich.text import Text

_GUTTER_STYLE = "bold blue"
_SEVERITY_STYLE = {"error": "bold red", "warning": "bold yellow"}
_SECONDARY_STYLE = "bold cyan"


class _Output(Protocol):
    """Text with styles, as rich has it."""

    def append(self, text: str, style: str | None = None) -> Any:
        """Add text in a style."""
        ...


class _Plain(list[str]):
    """Text without styles."""

    def append(self, text: str, style: str | None = None) -> None:
        """Add text."""
        super().append(text)


def for_people(diagnostics: Iterable[Diagnostic], width: int = 80) -> Text:
    """Every diagnostic with its source lines, carets and help, at most `width` cells wide where it can be."""
    from rich.text import Text  # slower to import than most runs are

    text = Text()
    _append_diagnostics(text, diagnostics, width)
    return text


def as_plain_text(diagnostics: Iterable[Diagnostic], width: int = 80) -> str:
    """The same without styles, for logs; messages are wrapped, too."""
    text = _Plain()
    _append_diagnostics(text, (_narrow(diagnostic, width) for diagnostic in diagnostics), width)
    return "".join(text)


def _narrow(diagnostic: Diagnostic, width: int) -> Diagnostic:
    before = len(f"{diagnostic.severity}[{diagnostic.rule}]: ")
    # Together with what comes before it, the first word stays where it is, however long it is.
    return replace(diagnostic, message=wrapped("x" * before + diagnostic.message, width, 2)[before:])


def summary(diagnostics: Sequence[Diagnostic]) -> str:
    """`2 errors, 1 warning`; empty if there is nothing to report."""
    counts = [
        (sum(d.severity == severity for d in diagnostics), severity) for severity in ("error", "warning")
    ]
    return ", ".join(f"{count} {word}{'s' * (count > 1)}" for count, word in counts if count)


def as_json(diagnostics: Sequence[Diagnostic]) -> str:
    """One JSON document, described in docs/cli.md. Lines and columns count from 1, columns in characters."""
    document = {
        "version": 1,
        "errors": sum(d.severity == "error" for d in diagnostics),
        "warnings": sum(d.severity == "warning" for d in diagnostics),
        "diagnostics": [
            {
                "rule": d.rule,
                "severity": d.severity,
                "message": d.message,
                "help": d.help,
                **({"breaks": d.breaks} if d.breaks else {}),
                "labels": [_label_as_json(label, label is d.primary) for label in _labels(d)],
            }
            for d in diagnostics
        ],
    }
    return json.dumps(document, indent=2, ensure_ascii=False)


def as_github_annotations(diagnostics: Iterable[Diagnostic]) -> str:
    """One workflow command a line: https://docs.github.com/actions/reference/workflow-commands-for-github-actions."""
    return "\n".join(map(_github_annotation, diagnostics))


def _labels(diagnostic: Diagnostic) -> tuple[Label, ...]:
    return () if diagnostic.primary is None else (diagnostic.primary, *diagnostic.secondary)


def _append_diagnostics(text: _Output, diagnostics: Iterable[Diagnostic], width: int) -> None:
    for index, diagnostic in enumerate(diagnostics):
        if index:
            text.append("\n")
        _append_diagnostic(text, diagnostic, width)


def _append_diagnostic(text: _Output, diagnostic: Diagnostic, width: int) -> None:
    style = _SEVERITY_STYLE[diagnostic.severity]
    text.append(f"{diagnostic.severity}[{diagnostic.rule}]", style)
    text.append(f": {printable(diagnostic.message)}\n", "bold")
    labels = _labels(diagnostic)
    gutter = max((len(str(label.span.line)) for label in labels), default=1)
    for arrow, source, of_source in _by_source(labels):
        first = of_source[0].span
        text.append(f"{' ' * gutter}{arrow} ", _GUTTER_STYLE)
        text.append(f"{printable(shown_source(source))}:{first.line}:{first.column}\n")
        text.append(f"{' ' * gutter} |\n", _GUTTER_STYLE)
        for line in sorted({label.span.line for label in of_source}):
            on_line = [label for label in of_source if label.span.line == line]
            _append_line(text, line, gutter, on_line, diagnostic, width)
    if diagnostic.help:
        lead = f"{' ' * gutter} = " if labels else "  = "
        text.append(lead, _GUTTER_STYLE)
        text.append("help", "bold green")
        text.append(": " + wrapped(diagnostic.help, width, len(lead) + len("help: ")) + "\n")


def _by_source(labels: Sequence[Label]) -> Iterator[tuple[str, Source, list[Label]]]:
    """Labels grouped by file: the primary label's file first, with the arrow that introduces each."""
    sources: list[Source] = []
    for label in labels:
        if not any(_is_same(label.span.source, source) for source in sources):
            sources.append(label.span.source)
    for index, source in enumerate(sources):
        of_source = [label for label in labels if _is_same(label.span.source, source)]
        yield "-->" if index == 0 else ":::", source, of_source


def _is_same(one: Source, other: Source) -> bool:
    return (one.path, one.revision) == (other.path, other.revision)


def _append_line(
    text: _Output, line: int, gutter: int, labels: Sequence[Label], diagnostic: Diagnostic, width: int
) -> None:
    source = labels[0].span.source
    view = _LineView(source.line(line), labels[0], max(width - gutter - 3, 20))
    text.append(f"{line:>{gutter}} | ", _GUTTER_STYLE)
    text.append(f"{view.text}".rstrip() + "\n")
    # From right to left, so that a text never crosses the marks of a label to its left.
    for label in sorted(labels, key=lambda label: -label.span.column):
        primary = label is diagnostic.primary
        before, length = view.marks(label)
        text.append(f"{' ' * gutter} | ", _GUTTER_STYLE)
        marks = " " * before + ("^" if primary else "-") * length
        said = f" {printable(label.text)}" if label.text else ""
        text.append(f"{marks}{said}\n", _SEVERITY_STYLE[diagnostic.severity] if primary else _SECONDARY_STYLE)


class _LineView:
    """A source line as the terminal shows it: tabs and wide characters measured, cropped around a label."""

    def __init__(self, line: str, focus: Label, width: int) -> None:
        self._cells = [shown_character(character) for character in line]
        self._left = [0]
        for cell in self._cells:
            self._left.append(self._left[-1] + _cell_width(cell))
        start, end = self._range(focus)
        room = width - (_text_width(focus.text) + 1 if focus.text else 0)
        self._first, self._last = self._crop(start, end, width, max(room, width // 2))
        self._lead = "…" if self._first else ""
        tail = "…" if self._last < len(self._cells) else ""
        self.text = self._lead + "".join(self._cells[self._first : self._last]) + tail

    def marks(self, label: Label) -> tuple[int, int]:
        """The number of cells before the marks of a label, and the number of marks (at least one)."""
        start, end = (min(max(index, self._first), self._last) for index in self._range(label))
        before = self._left[start] - self._left[self._first] + len(self._lead)
        return before, max(self._left[end] - self._left[start], 1)

    def _range(self, label: Label) -> tuple[int, int]:
        start = min(label.span.column - 1, len(self._cells))
        return start, min(start + max(label.span.end - label.span.start, 0), len(self._cells))

    def _crop(self, start: int, end: int, width: int, room: int) -> tuple[int, int]:
        """First and last (exclusive) character to show: all, or as much as fits with the label in sight."""
        if self._left[-1] <= width:
            return 0, len(self._cells)
        first = start
        while first and self._left[end] - self._left[first - 1] <= room - 4 and start - first < room // 2:
            first -= 1
        last = first
        while last < len(self._cells) and self._left[last + 1] - self._left[first] <= width - 2:
            last += 1
        return first, last


def _cell_width(cell: str) -> int:
    if cell.isascii():
        return len(cell)
    if unicodedata.combining(cell):
        return 0
    return 2 if unicodedata.east_asian_width(cell) in "WF" else 1


def _text_width(text: str) -> int:
    return sum(map(_cell_width, map(shown_character, text)))


def wrapped(text: str, width: int, indent: int = 0) -> str:
    """The text in lines of `width` cells, the first without the indent; nothing in it steers a terminal."""
    lines = [
        textwrap.fill(line, max(width - indent, 20), break_long_words=False, break_on_hyphens=False)
        for line in printable(text).split("\n")
    ]
    return "\n".join(lines).replace("\n", "\n" + " " * indent)


def _label_as_json(label: Label, primary: bool) -> dict[str, object]:
    source = label.span.source
    end_line, end_column = source.position(label.span.end)
    return {
        "path": Path(shown_path(source.path)).as_posix(),
        **({} if source.revision is None else {"revision": source.revision}),
        "start": {"line": label.span.line, "column": label.span.column},
        "end": {"line": end_line, "column": end_column},
        "text": label.text,
        "primary": primary,
    }


def _github_annotation(diagnostic: Diagnostic) -> str:
    properties = {"title": f"ifgen {diagnostic.rule}"}
    message = diagnostic.message
    elsewhere = _labels(diagnostic)
    if diagnostic.primary is not None and diagnostic.primary.span.source.revision is None:
        span = diagnostic.primary.span
        elsewhere = diagnostic.secondary
        end_line, end_column = span.source.position(span.end)
        properties = {
            "file": Path(shown_path(span.source.path)).as_posix(),
            "line": str(span.line),
            "endLine": str(end_line),
            "col": str(span.column),
            "endColumn": str(end_column),
            **properties,
        }
    for label in elsewhere:
        message += f"\n{shown_source(label.span.source)}:{label.span.line}: {label.text}"
    if diagnostic.help:
        message += f"\nhelp: {diagnostic.help}"
    listed = ",".join(f"{key}={_escape_property(value)}" for key, value in properties.items())
    return f"::{diagnostic.severity} {listed}::{_escape_data(message)}"


def _escape_data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _escape_property(text: str) -> str:
    return _escape_data(text).replace(":", "%3A").replace(",", "%2C")
