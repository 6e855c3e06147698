"""The choice of warnings: comments and `[tool.ifgen]` suppress some, `--strict` makes errors of the rest."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Final, Literal

from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Label, Source, Span

_MARK: Final = "ifgen:"
_COMMENT: Final = re.compile(r"[ \t]*(?:#+|//+|/\*+|<!--)[ \t]*ifgen:[ \t]*ignore\b(?:[ \t]*\[([^\]\n]*)\])?")
_NO_CODE: Final = re.compile(r"""\s*(?:\#(?!include[ \t]*["<])|//|/\*[^\n]*\*/\s*$|<!--|$)""")
_RULE: Final = re.compile(r"[^\s,]+")

RosDistro = Literal["humble", "iron", "jazzy", "kilted", "lyrical", "rolling"]

_OPTIONAL: Final = "optional-field"
_WITHOUT_OPTIONAL: Final = frozenset(("humble", "iron", "jazzy", "kilted"))


@dataclass(frozen=True)
class Policy:
    """The settings of `[tool.ifgen]` and the command line for warnings.

    `rules` are silenced everywhere, and those of `per_file` in the files that match a pattern, by their path
    relative to `base` or by their name. With `strict` all other warnings are errors.
    """

    rules: frozenset[str] = frozenset()
    per_file: Mapping[str, frozenset[str]] = field(default_factory=dict[str, frozenset[str]])
    base: Path = Path()
    strict: bool = False

    def told(self, found: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """The diagnostics that are not silenced, with a readable number of them for each file."""
        told: list[Diagnostic] = []
        warned: dict[Path, list[Diagnostic]] = {}
        for diagnostic in found:
            if diagnostic.severity == "warning":
                if self.silences(diagnostic):
                    continue
                if diagnostic.primary is not None:
                    of_file = warned.setdefault(diagnostic.primary.span.source.path, [])
                    of_file.append(diagnostic)
                    if len(of_file) > MAX_PROBLEMS:
                        continue
            told.append(diagnostic)
        told += (_more(of_file) for of_file in warned.values() if len(of_file) > MAX_PROBLEMS)
        return tuple(replace(d, severity="error") for d in told) if self.strict else tuple(told)

    def silences(self, warning: Diagnostic) -> bool:
        """Whether the configuration silences a warning."""
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
    """The diagnostics of a file, without the warnings that its comments silence.

    If `found` is `complete`, so that there are no other warnings, comments that silence nothing are reported
    too.
    """
    if _MARK not in source.text:
        return list(found)
    comments = _Comments(source)
    kept = [d for d in found if d.severity == "error" or not comments.silence(d)]
    return [*kept, *comments.unused()] if complete else kept


def without_directive(comment: str) -> str:
    """The comment of a line without `# ifgen: ignore[...]` and what follows it: that is no documentation."""
    found = _COMMENT.search(comment) if _MARK in comment else None
    return comment[: found.start()].rstrip() if found else comment


def is_old(ros_distro: str | None) -> bool:
    """Whether rosidl of a distribution refuses what newer ones read. One that is unknown counts as new."""
    return ros_distro in _WITHOUT_OPTIONAL


def judged(found: Iterable[Diagnostic], ros_distro: str | None) -> list[Diagnostic]:
    """The findings, where those are errors that the rosidl of a distribution makes errors of."""
    if not is_old(ros_distro):
        return list(found)
    name = str(ros_distro).capitalize()
    message = f"ROS 2 {name} does not know `@optional`"
    advice = (
        'remove it: it came with Lyrical. If that is your ROS 2, set `ros_distro = "lyrical"` in [tool.ifgen]'
    )
    return [
        replace(d, message=message, help=advice, severity="error") if d.rule == _OPTIONAL else d
        for d in found
    ]


def refused(found: Iterable[Diagnostic], ros_distro: str | None) -> list[Diagnostic]:
    """Those of the warnings that are errors for a distribution."""
    return [d for d in judged(found, ros_distro) if d.severity == "error"]


@dataclass
class _Mention:
    """A rule in a comment `# ifgen: ignore[rule, ...]`."""

    rule: str
    place: Span
    used: bool = False


class _Comments:
    """The comments of a file that silence. One alone on its line speaks for all up to the next definition."""

    def __init__(self, source: Source) -> None:
        self._mentions: list[_Mention] = []
        self._without_rule: list[Span] = []
        self._on_line: dict[int, dict[str, _Mention]] = {}
        above: dict[str, _Mention] = {}
        start = 0
        for number, line in enumerate(source.text.splitlines(keepends=True), 1):
            own = {mention.rule: mention for mention in self._in_line(source, line, start)}
            if _NO_CODE.match(line):
                above.update(own)
                mentions = above  # one for all lines of a block
            else:
                mentions, above = {**above, **own}, {}
            if mentions:
                self._on_line[number] = mentions
            start += len(line)

    def _in_line(self, source: Source, line: str, start: int) -> list[_Mention]:
        found = _COMMENT.search(line) if _MARK in line else None
        if found is None:
            return []
        at = start + found.start(1)
        mentions = [
            _Mention(rule[0], Span(source, at + rule.start(), at + rule.end()))
            for rule in _RULE.finditer(found[1] or "")
        ]
        if not mentions:
            end = start + found.end()
            self._without_rule.append(Span(source, end - len(found[0].lstrip()), end))
        self._mentions += mentions
        return mentions

    def silence(self, warning: Diagnostic) -> bool:
        """Whether a warning is silenced by a comment, which is of use then."""
        on_line = self._on_line.get(warning.primary.span.line, {}) if warning.primary else {}
        mention = on_line.get(warning.rule)
        if mention is None:
            return False
        mention.used = True
        return True

    def unused(self) -> Iterator[Diagnostic]:
        """Say which comments have silenced nothing."""
        for place in self._without_rule:
            yield _unused(place, "this comment names no rule", "write `ifgen: ignore[RULE]`")
        for mention in self._mentions:
            if not mention.used:
                from ifgen.config import rulebook  # which is read where somebody may have named a wrong rule

                # Only a comparison, or a look at the whole system, can tell.
                if rulebook.is_of_changes(mention.rule) or mention.rule.startswith("system-"):
                    continue
                advice = "delete it, or move it to the line of the warning or above that"
                nothing = f"there is no warning `{mention.rule}` here", advice
                yield _unused(mention.place, *(rulebook.why_not_ignored(mention.rule) or nothing))


def _unused(place: Span, message: str, advice: str | None) -> Diagnostic:
    label = Label(place, "this silences nothing")
    return Diagnostic("unused-ignore", message, label, help=advice, severity="warning")


def _more(of_file: Sequence[Diagnostic]) -> Diagnostic:
    last = of_file[-1].primary
    assert last is not None
    count = len(of_file) - MAX_PROBLEMS
    message = f"and {count} more warning{'s' * (count > 1)} in this file"
    return Diagnostic("more-warnings", message, last, severity="warning")
