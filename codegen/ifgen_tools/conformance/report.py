"""Running the suite, and what came of it: counts, the list of expected failures, JUnit XML and JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Final, Literal
from xml.sax.saxutils import quoteattr

from ifgen.command_kit.tool import ToolError

from ifgen_tools.conformance.cases import MEMORY, Case
from ifgen_tools.conformance.testee import Testee

Outcome = Literal["passed", "failed", "expected", "skipped"]
_OUTCOMES: Final[tuple[Outcome, ...]] = ("passed", "failed", "expected", "skipped")
_LONGEST: Final = 1000
"""Characters of the first failures that are printed."""


@dataclass(slots=True)
class Expectation:
    """A line of the list of expected failures. With `some`, cases that match it may pass, too."""

    pattern: str
    some: bool
    reason: str
    line: int
    failed: int = 0
    passed: list[str] = field(default_factory=list[str])


def read_expectations(path: Path) -> list[Expectation]:
    """The lines `[some] GLOB  reason` of a file; ToolError for a line without a reason."""
    expectations: list[Expectation] = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        some = words[0] == "some"
        pattern, *reason = words[some:] or [""]
        if not reason:
            raise ToolError(
                f"{path}:{number}: expected `[some] PATTERN REASON`, got {line.strip()!r}",
                "write why these cases fail after the pattern",
            )
        expectations.append(Expectation(pattern, some, " ".join(reason), number))
    return expectations


@dataclass(frozen=True, slots=True)
class Result:
    """The outcome of one case, and what is wrong or was skipped."""

    case: Case
    outcome: Outcome
    detail: str = ""


@dataclass(slots=True)
class Report:
    """All results of one testee."""

    about: dict[str, str]
    expectations: list[Expectation]
    results: list[Result] = field(default_factory=list[Result])

    def add(self, case: Case, problem: str | None, skipped: str) -> Result:
        """Record a result."""
        matching = [entry for entry in self.expectations if fnmatchcase(case.name, entry.pattern)]
        if skipped:
            result = Result(case, "skipped", skipped)
        elif problem is None:
            for entry in matching:
                entry.passed.append(case.name)
            result = Result(case, "passed")
        else:
            for entry in matching:
                entry.failed += 1
            result = Result(case, "expected" if matching else "failed", problem)
        self.results.append(result)
        return result

    @property
    def unexpected_passes(self) -> Iterator[str]:
        """A sentence for each line of the list that does not hold any more."""
        for entry in self.expectations:
            if entry.passed and not (entry.some and entry.failed):
                count = len(entry.passed)
                more = f" and {count - 1} more" if count > 1 else ""
                yield f"line {entry.line}: `{entry.pattern}` should fail, but {entry.passed[0]}{more} passed"

    @property
    def is_right(self) -> bool:
        """Whether nothing failed or passed unexpectedly."""
        return not any(result.outcome == "failed" for result in self.results) and not any(
            self.unexpected_passes
        )

    def table(self) -> dict[str, Counter[Outcome]]:
        """The number of each outcome, by group."""
        groups: dict[str, Counter[Outcome]] = {}
        for result in self.results:
            groups.setdefault(result.case.group, Counter())[result.outcome] += 1
        return dict(sorted(groups.items()))

    def lines(self) -> Iterator[str]:
        """A table for people."""
        yield f"{'':12}" + "".join(f"{outcome:>10}" for outcome in _OUTCOMES)
        table = self.table()
        for group, counts in (*table.items(), ("all", sum(table.values(), Counter[Outcome]()))):
            yield f"{group:12}" + "".join(f"{counts[outcome]:>10,}" for outcome in _OUTCOMES)

    def as_json(self) -> dict[str, Any]:
        """The result for tools, with every case that did not pass."""
        return {
            "testee": self.about,
            "passed": self.is_right,
            "groups": {group: dict(counts) for group, counts in self.table().items()},
            "cases": [
                {"name": result.case.name, "outcome": result.outcome, "detail": result.detail}
                for result in self.results
                if result.outcome != "passed"
            ],
            "unexpected_passes": list(self.unexpected_passes),
        }

    def as_junit(self) -> str:
        """The result as JUnit XML."""
        counts = sum(self.table().values(), Counter[Outcome]())
        lines = ['<?xml version="1.0" encoding="utf-8"?>']
        skipped = counts["skipped"] + counts["expected"]
        numbers = f'tests="{len(self.results)}" failures="{counts["failed"]}" skipped="{skipped}"'
        lines.append(f'<testsuite name="conformance" {numbers}>')
        for result in self.results:
            attributes = f"classname={quoteattr(result.case.group)} name={quoteattr(result.case.name)}"
            element = {"passed": "", "failed": "failure"}.get(result.outcome, "skipped")
            inner = f"<{element} message={quoteattr(result.detail)}/>" if element else ""
            lines.append(f"<testcase {attributes}>{inner}</testcase>")
        return "\n".join([*lines, "</testsuite>\n"])


def run(testee: Testee, cases: Iterable[Case], report: Report) -> Iterator[Result]:
    """Ask the testee each case, and record the results."""
    skipped = set(report.about.get("skip", "").split(","))
    largest = int(report.about.get("max_payload") or 0)
    for case in cases:
        named = skipped & {case.op, case.group}
        if named:
            yield report.add(case, None, f"the testee skips {named.pop()}")
            continue
        if largest and any(len(argument) > 2 * largest for argument in case.arguments):
            yield report.add(case, None, f"the testee takes {largest} bytes at most")
            continue
        before = testee.peak if case.is_hostile else 0
        reply = testee.ask(case.op, case.type_name, *case.arguments)
        if reply.verdict == "skip":
            yield report.add(case, None, reply.data)
            continue
        problem = case.problem(reply)
        if case.is_hostile and before and testee.peak - before > MEMORY:
            problem = f"took {(testee.peak - before) >> 20} MiB to read it"
        yield report.add(case, problem, "")
