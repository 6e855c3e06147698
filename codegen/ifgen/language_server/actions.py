"""Quick fixes: those of `ifgen check --fix`, a name that a finding suggests, a comment that silences."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Diagnostic, Source, Span
from ifgen.pipeline.fixing import declaring, fixed

_SUGGESTED: Final = re.compile(r"did you mean [`']([^`']+)[`'](?: or [`']([^`']+)[`'])?\?")
_COMMENTS: Final = {".idl": "//", ".msg": "#", ".srv": "#", ".action": "#", ".yaml": "#", ".yml": "#"}

Texts = dict[Path, str]
"""The new texts of files."""


def quick_fixes(diagnostic: Diagnostic) -> Iterator[tuple[str, Texts, bool]]:
    """Titles, the new texts of files, and whether it is what the finding asks for."""
    for path, (_, after) in fixed([diagnostic]).items():
        yield f"Fix {diagnostic.rule} in {path.name}", {path: after}, True
    if diagnostic.primary is None:
        return
    span = diagnostic.primary.span
    for name in _suggestions(diagnostic):
        yield f"Change to `{name}`", {span.source.path: _replaced(span, name)}, True
    if diagnostic.severity == "warning" and span.source.path.suffix in _COMMENTS:
        yield (
            f"Ignore {diagnostic.rule} here",
            {span.source.path: _silenced(span.source, span.line, diagnostic.rule)},
            False,
        )


def dependency_texts(root: Path, package: str) -> Texts:
    """The new texts of package.xml and CMakeLists.txt with a package as a dependency."""
    return {path: after for path, (_, after) in declaring(root, package).items()}


def _suggestions(diagnostic: Diagnostic) -> list[str]:
    """The names that the help of a finding suggests, in the form of the text at its place."""
    assert diagnostic.primary is not None
    span = diagnostic.primary.span
    word = span.source.text[span.start : span.end]
    match = _SUGGESTED.search(diagnostic.help or "")
    names = [name for name in match.groups() if name] if match is not None else []
    package, slash, _ = word.rpartition("/")
    if diagnostic.rule == "unknown-package":
        return [f"{name}/{word.partition('/')[2]}" if slash else name for name in names]
    return [f"{package}/{name}" if slash and "/" not in name else name for name in names]


def _replaced(span: Span, text: str) -> str:
    whole = span.source.text
    return f"{whole[: span.start]}{text}{whole[span.end :]}"


def _silenced(source: Source, line: int, rule: str) -> str:
    """The text with a comment that silences a rule, above a line."""
    lines = source.text.split("\n")
    indent = re.match(r"\s*", lines[line - 1])
    assert indent is not None
    comment = f"{indent[0]}{_COMMENTS[source.path.suffix]} ifgen: ignore[{rule}]"
    return "\n".join([*lines[: line - 1], comment, *lines[line - 1 :]])
