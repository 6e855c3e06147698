"""Diagnostics stored between runs: JSON, with the files that they point to as they were read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.pipeline.freshness.fingerprints import of_source, of_text, sources_of
from ifgen.reading.storage import read_limited

Document: TypeAlias = dict[str, Any]


def as_document(found: Sequence[Diagnostic]) -> Document:
    """The form from which `from_document` makes the same diagnostics."""
    sources = list(dict.fromkeys(source for diagnostic in found for source in sources_of(diagnostic)))
    number = {source: index for index, source in enumerate(sources)}

    def label(label: Label) -> list[object]:
        return [number[label.span.source], label.span.start, label.span.end, label.text]

    return {
        "files": [[str(source.path), source.text] for source in sources],
        "found": [
            [
                diagnostic.rule,
                diagnostic.message,
                diagnostic.primary and label(diagnostic.primary),
                [label(secondary) for secondary in diagnostic.secondary],
                diagnostic.help,
                diagnostic.severity,
            ]
            for diagnostic in found
        ],
    }


def from_document(document: Document) -> tuple[Diagnostic, ...] | None:
    """The diagnostics, if the files that they point at are still as they were.

    Raises KeyError, TypeError, ValueError or IndexError for a document that is none.
    """
    sources = [Source(Path(path), text) for path, text in document["files"]]
    if not all(map(_is_current, sources)):
        return None

    def label(place: tuple[int, int, int, str]) -> Label:
        index, start, end, text = place
        return Label(Span(sources[index], start, end), text)

    return tuple(
        Diagnostic(rule, message, primary and label(primary), tuple(map(label, secondary)), help, severity)
        for rule, message, primary, secondary, help, severity in document["found"]
    )


def _is_current(source: Source) -> bool:
    try:
        return of_text(read_limited(source.path)) == of_source(source)
    except OSError:
        return False
