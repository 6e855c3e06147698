"""Mistakes in templates, as diagnostics."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from jinja2 import nodes

from ifgen.diagnostics import Diagnostic, Label, Severity
from ifgen.generator_py.templates.check.frame import Frame

_LISTED = 12


class Reporter:
    """Collects what is wrong in `problems`: each place and message once."""

    def __init__(self) -> None:
        self.problems: dict[tuple[str, int, str], Diagnostic] = {}

    def report(  # noqa: PLR0913 - one place where a problem gets its form
        self,
        frame: Frame,
        node: nodes.Node,
        rule: str,
        message: str,
        *,
        word: str = "",
        known: Iterable[str] = (),
        advice: str | None = None,
        warning: bool = False,
    ) -> None:
        """Note a problem at a node; `word` is the part of it to point to, `known` what it may have meant."""
        span = frame.template.span(node, word)
        advice = advice or _advice(word, sorted(known))
        severity: Severity = "warning" if warning else "error"
        found = Diagnostic(rule, message, Label(span), help=advice, severity=severity)
        self.problems.setdefault((str(span.source.path), span.start, message), found)


def _advice(word: str, known: Sequence[str]) -> str | None:
    close = get_close_matches(word, known, n=1) if word else ()
    if close:
        return f"did you mean '{close[0]}'?"
    return f"known here: {', '.join(known)}" if known and len(known) <= _LISTED else None
