"""Which warnings are told: comments and `[tool.ifgen]` silence some, `--strict` makes errors of the rest."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Label, Source, Span

_MARK: Final = "ifgen:"
_COMMENT: Final = re.compile(r"[ \t]*(?:#+|//+|<!--)[ \t]*ifgen:[ \t]*ignore\b(?:[ \t]*\[([^\]\n]*)\])?")
_NO_CODE: Final = re.compile(r"\s*(?:#|//|<!--|$)")
_RULE: Final = re.compile(r"[^\s,]+")


@dataclass(frozen=True)
class Policy:
    """What `[tool.ifgen]` and the command line say of warnings.

    `rules` are silenced everywhere, and those of `per_file` in the files that match a pattern: by their path
    from `base` on, or by their name. With `strict` all other warnings are errors.
    """

    rules: frozenset[str] = frozenset()
    per_file: Mapping[str, frozenset[str]] = field(default_factory=dict[str, frozenset[str]])
    base: Path = Path()
    strict: bool = False

    def told(self, found: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """What is to be told of what was found: of each file no more than somebody wants to read."""
        told: list[Diagnostic] = []
        warned: dict[Path, list[Diagnostic]] = {}
        for diagnostic in found:
            if diagnostic.severity == "warning":
                if self._silences(diagnostic):
                    continue
                if diagnostic.primary is not None:
                    of_file = warned.setdefault(diagnostic.primary.span.source.path, [])
                    of_file.append(diagnostic)
                    if len(of_file) > MAX_PROBLEMS:
                        continue
            told.append(diagnostic)
        told += (_more(of_file) for of_file in warned.values() if len(of_file) > MAX_PROBLEMS)
        return tuple(replace(d, severity="error") for d in told) if self.strict else tuple(told)

    def _silences(self, warning: Diagnostic) -> bool:
        if warning.rule in self.rules:
            return True
        if warning.primary is None or not self.per_file:
            return False
        path = Path(os.path.abspath(warning.primary.span.source.path))  # noqa: PTH100 - without `..`
        shown = path.relative_to(self.base) if path.is_relative_to(self.base) else path
        return any(
            warning.rule in rules and (fnmatch(shown.as_posix(), pattern) or fnmatch(path.name, pattern))
            for pattern, rules in self.per_file.items()
        )


def by_comments(source: Source, found: Sequence[Diagnostic], *, complete: bool = True) -> list[Diagnostic]:
    """What was found in a file, without the warnings that its comments silence.

    Comments that silence nothing are told too, if `found` is `complete`: if there is no other warning.
    """
    if _MARK not in source.text:
        return list(found)
    comments = list(_comments(source))
    kept = [d for d in found if d.severity == "error" or not any(c.silences(d) for c in comments)]
    return kept + [unused for c in comments for unused in c.unused()] if complete else kept


def without_directive(comment: str) -> str:
    """The comment of a line without `# ifgen: ignore[...]` and what follows it: that is no documentation."""
    found = _COMMENT.search(comment) if _MARK in comment else None
    return comment[: found.start()].rstrip() if found else comment


class _Comment:
    """One `# ifgen: ignore[rule, ...]`: its place, its rules, and the lines that it speaks for."""

    def __init__(self, place: Span, rules: Mapping[str, Span], lines: range) -> None:
        self._place = place
        self._rules = rules
        self._unused = dict(rules)
        self._lines = lines

    def silences(self, warning: Diagnostic) -> bool:
        """Whether it silences a warning of its file; it is of use then."""
        label = warning.primary
        if label is None or warning.rule not in self._rules or label.span.line not in self._lines:
            return False
        self._unused.pop(warning.rule, None)
        return True

    def unused(self) -> Iterator[Diagnostic]:
        """Say which of its rules have silenced nothing."""
        if not self._rules:
            yield _unused(self._place, "this comment names no rule", "write `ifgen: ignore[RULE]`")
        for rule, place in self._unused.items():
            from ifgen import rulebook  # which is read where somebody may have named a wrong rule

            advice = "delete it, or move it to the line of the warning or above that"
            nothing = f"there is no warning `{rule}` here", advice
            yield _unused(place, *(rulebook.why_not_ignored(rule) or nothing))


def _comments(source: Source) -> Iterator[_Comment]:
    """The comments of a file that silence. One alone on its line speaks for all up to the next definition."""
    lines = source.text.splitlines(keepends=True)
    start = 0
    for number, line in enumerate(lines, 1):
        if _MARK in line and (found := _COMMENT.search(line)):
            last = number
            if _NO_CODE.match(line):
                while last < len(lines) and _NO_CODE.match(lines[last - 1]):
                    last += 1
            at = start + found.start(1)
            rules = {m[0]: Span(source, at + m.start(), at + m.end()) for m in _RULE.finditer(found[1] or "")}
            written = found[0].lstrip()
            place = Span(source, start + found.end() - len(written), start + found.end())
            yield _Comment(place, rules, range(number, last + 1))
        start += len(line)


def _unused(place: Span, message: str, advice: str | None) -> Diagnostic:
    label = Label(place, "this silences nothing")
    return Diagnostic("unused-ignore", message, label, help=advice, severity="warning")


def _more(of_file: Sequence[Diagnostic]) -> Diagnostic:
    last = of_file[-1].primary
    assert last is not None
    count = len(of_file) - MAX_PROBLEMS
    message = f"and {count} more warning{'s' * (count > 1)} in this file"
    return Diagnostic("more-warnings", message, last, severity="warning")
