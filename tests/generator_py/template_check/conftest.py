"""Checks templates that are written in tests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from ifgen.config.customization import Customization
from ifgen.diagnostics import Diagnostic, InputError, Source
from ifgen.generator_py.messages.context import InterfaceModule
from ifgen.generator_py.templates.check.check import Checker
from ifgen.generator_py.templates.check.syntax import Template, parse_text
from ifgen.generator_py.templates.render import _environment_for
from ifgen.model import Interface

Check = Callable[..., "Found"]


@dataclass(frozen=True)
class Found:
    """The findings, as `rule line:column message`."""

    diagnostics: tuple[Diagnostic, ...]

    @property
    def lines(self) -> list[str]:
        return [_line(diagnostic) for diagnostic in self.diagnostics]

    @property
    def errors(self) -> list[str]:
        return [_line(d) for d in self.diagnostics if d.severity == "error"]


def _line(diagnostic: Diagnostic) -> str:
    assert diagnostic.primary is not None
    span = diagnostic.primary.span
    place = f"{span.line}:{span.column}"
    text = f"{diagnostic.rule} {place} {diagnostic.message}"
    if diagnostic.primary.text:
        text += f": {diagnostic.primary.text}"
    return text


@pytest.fixture
def check() -> Check:
    """`check(text, {"other.j2": text})` checks a template whose context has `module` and `interface`."""
    return check_text


def check_text(text: str, others: Mapping[str, str] | None = None) -> Found:
    texts = {"t.j2": text, **(others or {})}
    environment = _environment_for(Customization())
    parsed: dict[str, Template] = {}

    def load(name: str) -> Template | None:
        if name in texts and name not in parsed:
            parsed[name] = parse_text(name, Source(Path(name), texts[name]), environment)
        return parsed.get(name)

    checker = Checker(environment, load, texts)
    try:
        checker.check("t.j2", {"module": InterfaceModule, "interface": Interface})
    except InputError as error:  # the checker collects the templates that it is asked to load
        raise AssertionError(error) from error
    return Found(tuple(checker.found()))
