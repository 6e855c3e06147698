"""The parameters that nodes get at their start, from launch files and from parameter files."""
# What launch files say is Any.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span
from ifgen.nodl import parameter_files
from ifgen.nodl.syntax import reader
from ifgen.nodl.syntax.tree import Key, ListNode, MapNode, Node, ScalarNode
from ifgen.reading.storage import read_source

from ifgen_tools.system.model import Parameter, Section


@dataclass(frozen=True, slots=True)
class _File:
    """The parts of a parameter file: a pattern of nodes, its key, and parameters with their places."""

    sections: tuple[tuple[str, Key, MapNode], ...] = ()


@dataclass
class ParameterFiles:
    """Parameter files, each read once, who gets them, and what is wrong with their text."""

    findings: list[Diagnostic] = field(default_factory=list[Diagnostic])
    _files: dict[tuple[Path, str | None], _File] = field(
        default_factory=dict[tuple[Path, "str | None"], _File]
    )
    _receivers: dict[tuple[str, Span], list[str]] = field(default_factory=dict[tuple[str, Span], "list[str]"])

    def values(
        self, path: Path, node: str, span: Span | None = None, text: str | None = None
    ) -> Iterator[Parameter]:
        """The values in a file, named at a place of a launch file, for a node of this full name."""
        for pattern, key, parameters in self._read(path, span, text).sections:
            self._receivers.setdefault((pattern, key.span), []).append(node)
            if matches(pattern, node):
                for name, place, value in parameter_files.flat_entries(parameters, ""):
                    yield Parameter(name, value, pattern, place.span)

    def sections(self) -> tuple[Section, ...]:
        """The parts of all files that were asked for, each with the nodes that get it."""
        return tuple(
            Section(pattern, tuple(nodes), span) for (pattern, span), nodes in self._receivers.items()
        )

    def _read(self, path: Path, span: Span | None, text: str | None) -> _File:
        key = (path.absolute(), text)
        if key not in self._files:
            self._files[key] = self._parsed(path, span, text)
        return self._files[key]

    def _parsed(self, path: Path, span: Span | None, text: str | None) -> _File:
        try:
            source = read_source(path) if text is None else Source(path, text)
        except InputError as error:
            missing = f"there is no parameter file '{path}'" if not path.is_file() else None
            for each in error.diagnostics:
                label = Label(span, "named here") if span else each.primary
                message = missing or each.message
                self.findings.append(Diagnostic("system-parameter-file", message, label, help=each.help))
            return _File()
        problems = FileProblems(source)
        try:
            root = reader.parse(source, problems)
        except reader.UnreadableError as error:
            self.findings.append(error.diagnostic)
            return _File()
        found = tuple(parameter_files.sections(root, "", problems))
        self.findings += problems.errors()
        return _File(found)


def given(name: str, value: Any, span: Span | None) -> Parameter:
    """A parameter that a launch file spells out; None stands for what only a run tells."""
    return Parameter(name, None if value is None or span is None else _tree(value, span), "", span)


def _tree(value: Any, span: Span) -> Node:
    if isinstance(value, list | tuple | bytes):
        items: Sequence[Any] = value
        return ListNode(tuple(_tree(each, span) for each in items), span, len(items) + 1)
    return ScalarNode(value if isinstance(value, bool | int | float) else str(value), span, plain=False)


def matches(pattern: str, node: str) -> bool:
    """Whether a part of a parameter file is for a node of this full name: `*` is one part of it, `**` any."""
    return _expression(pattern).fullmatch(node) is not None


@cache
def _expression(pattern: str) -> re.Pattern[str]:
    parts = (part for part in pattern.split("/") if part)
    words = {"**": r"(/[^/]+)*", "*": r"/[^/]+"}
    return re.compile("".join(words.get(part, rf"/{re.escape(part)}") for part in parts))
