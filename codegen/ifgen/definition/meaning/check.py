"""Warnings about tags in comments that cannot be read."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from typing import Final

from ifgen.definition.interfaces import Field
from ifgen.definition.meaning.reading import mistakes_of
from ifgen.definition.meaning.tags import Mistake
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span

_OWN_COMMENTS: Final = re.compile(r"[^\n]*(?:\n[ \t]+#[^\n]*|\n[ \t]*(?=\n))*")


def check_tags(fields: Iterable[Field], constants: Collection[str], problems: FileProblems) -> None:
    """Warn of each tag of a message that cannot be read; `constants` are the names of its constants."""
    for field in fields:
        if field.span is not None and (field.documentation or field.unit or field.annotations):
            for mistake in mistakes_of(field, constants):
                problems.warning(_invalid_tag, mistake, field.span)


def _invalid_tag(mistake: Mistake, field: Span) -> Diagnostic:
    return Diagnostic(
        "invalid-tag",
        mistake.message,
        Label(_span(mistake.tag, field), "this says nothing"),
        help=mistake.advice or None,
        severity="warning",
    )


def _span(tag: str, field: Span) -> Span:
    """The place of a tag: after its field, or else in the lines above; the field where it is in neither."""
    text = field.source.text
    below = _OWN_COMMENTS.match(text, field.end)
    start = text.find(tag, field.end, below.end() if below else field.end)
    start = start if start >= 0 else text.rfind(tag, 0, field.start)
    return field if start < 0 else Span(field.source, start, start + len(tag))
