"""Every rule that a diagnostic may name, as docs/rules.md lists them: that page is the table."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from ifgen import resources
from ifgen.diagnostics import Severity, did_you_mean

_HEADING: Final = re.compile(r"^## (?P<section>.*)$|^### `(?P<rule>.*)`$", re.MULTILINE)
_CHANGES: Final = "Breaking changes"
_EXAMPLE: Final = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule: how severe it is, what it is about, and an example of what breaks it.

    One that is a warning in some cases and an error in others counts as a warning. `language` says what the
    example is written in: `msg`, `yaml`, `console`; `diff` for two versions. `of_changes` is true for the
    rules of `ifgen breaking`, which can be ignored although they are errors.
    """

    name: str
    severity: Severity
    text: str
    example: str
    language: str
    of_changes: bool = False

    @property
    def summary(self) -> str:
        """The first sentence about it."""
        return self.text.partition(". ")[0].removesuffix(".")


@lru_cache(maxsize=1)
def rules() -> Mapping[str, Rule]:
    """All rules by name. Raises OSError if the page is missing."""
    page = resources.rules_page().read_text(encoding="utf-8")
    found: dict[str, Rule] = {}
    section = ""
    headings = list(_HEADING.finditer(page))
    for heading, end in zip(headings, [*(h.start() for h in headings[1:]), len(page)], strict=True):
        section = heading["section"] or section
        if name := heading["rule"]:
            body = page[heading.end() : end]
            example = _EXAMPLE.search(body)
            assert example is not None, f"the rule {name} has no example"
            severity: Severity = "warning" if section == "Warnings" else "error"
            text = " ".join(body[: example.start()].split())
            of_changes = section == _CHANGES
            found[name] = Rule(name, severity, text, example[2], example[1], of_changes)
    return found


def is_of_changes(name: str) -> bool:
    """Whether a rule is one of `ifgen breaking`."""
    known = rules().get(name)
    return known is not None and known.of_changes


def meant(name: str) -> str | None:
    """A hint at the rules that somebody may have meant."""
    return did_you_mean(name, rules(), form="`{}`", limit=2) or None


def why_not_ignored(name: str) -> tuple[str, str | None] | None:
    """The reason why a rule of this name cannot be silenced, and what to do; None if it is a warning."""
    known = rules().get(name)
    if known is None:
        return f"there is no rule `{name}`", meant(name) or "`ifgen rules` lists them"
    if known.severity == "error" and not known.of_changes:
        return f"`{name}` is an error, which cannot be ignored", None
    return None
