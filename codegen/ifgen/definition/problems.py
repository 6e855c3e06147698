"""Collects what is wrong with one file, up to a sensible number."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Final, ParamSpec

from ifgen.config import suppressions
from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Label, Source, Span

P = ParamSpec("P")

_MAX_PLACES: Final = 5


class FileProblems:
    """The findings of one file. An error is only explained as long as it will be shown.

    `sees_all` is false where a look at other files too would find more warnings.
    """

    def __init__(self, source: Source, with_warnings: bool = True) -> None:
        self._source = source
        self._with_warnings = with_warnings
        self._errors: list[Diagnostic] = []
        self._warnings: list[Diagnostic] = []
        self._unexplained = 0
        self.sees_all = True

    def __bool__(self) -> bool:
        return bool(self._errors)

    def extend(self, errors: Iterable[Diagnostic], unexplained: int) -> None:
        """Take over what the parser found."""
        self._errors.extend(errors)
        self._unexplained += unexplained

    def error(self, explain: Callable[P, Diagnostic], *args: P.args, **kwargs: P.kwargs) -> None:
        """Report an error that `explain` puts into words."""
        if len(self._errors) < MAX_PROBLEMS:
            self._errors.append(explain(*args, **kwargs))
        else:
            self._unexplained += 1

    def warning(self, explain: Callable[P, Diagnostic], *args: P.args, **kwargs: P.kwargs) -> None:
        """Report a warning, unless it is about a file of others."""
        if self._with_warnings:
            self._warnings.append(explain(*args, **kwargs))

    def errors(self) -> list[Diagnostic]:
        """The errors by their place, and how many more there are."""
        found = sorted(self._errors, key=_place)
        if self._unexplained:
            found.append(self._more())
        return found

    def warnings(self) -> list[Diagnostic]:
        """The warnings by their place, without those that comments in the file suppressions."""
        if not self._with_warnings:
            return []
        complete = self.sees_all and not self._errors
        return suppressions.by_comments(self._source, sorted(self._warnings, key=_place), complete=complete)

    def _more(self) -> Diagnostic:
        end = len(self._source.text)
        count = f"{self._unexplained} more {'error' if self._unexplained == 1 else 'errors'}"
        return Diagnostic(
            "more-errors",
            f"and {count} in this file",
            Label(Span(self._source, end, end)),
            help="fix the first ones and try again",
        )


def one_for_each_cause(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    """One finding for each package that is unknown, with the other places that name it."""
    kept: dict[object, Diagnostic] = {}
    for number, diagnostic in enumerate(found):
        is_cause = diagnostic.rule == "unknown-package" and diagnostic.primary is not None
        first = kept.setdefault(diagnostic.message if is_cause else number, diagnostic)
        if first is not diagnostic and diagnostic.primary is not None:
            others = (Label(label.span, "nor here") for label in (diagnostic.primary, *diagnostic.secondary))
            places = dict.fromkeys((*first.secondary, *others))
            kept[diagnostic.message] = replace(first, secondary=tuple(places)[:_MAX_PLACES])
    return list(kept.values())


def _place(diagnostic: Diagnostic) -> int:
    return diagnostic.primary.span.start if diagnostic.primary else 0
