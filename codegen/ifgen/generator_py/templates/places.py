"""Places in the user's templates and filters."""

from __future__ import annotations

from pathlib import Path

from ifgen.diagnostics import Label, Source, Span
from ifgen.reading.storage import read_limited


def at_line(path: Path, line: int, text: str) -> Label:
    """A label on a whole line of a file, without its indentation."""
    source = Source(path, read_limited(path).decode("utf-8", "replace"))
    start = sum(len(text) for text in source.text.splitlines(keepends=True)[: line - 1])
    shown = source.line(line)
    indent = len(shown) - len(shown.lstrip())
    return Label(Span(source, start + indent, start + len(shown)), text)
