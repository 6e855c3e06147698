"""Templates of the user's that replace ours: what is wrong with them, as diagnostics."""

from __future__ import annotations

import traceback
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path

import jinja2
import jinja2.meta

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InterfaceError, Label, Source, Span


def check_overrides(environment: jinja2.Environment, folders: Sequence[Path]) -> None:
    """Raise InterfaceError for templates in the folders that do not parse or that nothing uses.

    One is used if it has the name of one of ours, or if another one in the folders names it.
    """
    ours = set(_names(resources.templates()))
    problems: list[Diagnostic] = []
    used = set(ours)
    for folder in folders:
        for name in _names(folder):
            try:
                tree = environment.parse(
                    (folder / name).read_text(encoding="utf-8"), name, str(folder / name)
                )
            except jinja2.TemplateSyntaxError as error:
                problems.append(_at(folder / name, error.lineno, "template-syntax", str(error.message)))
            else:
                used.update(filter(None, jinja2.meta.find_referenced_templates(tree)))
    unused = ((folder / name, name) for folder in folders for name in _names(folder) if name not in used)
    problems += (_unused(path, name, ours) for path, name in unused)
    if problems:
        raise InterfaceError(problems)


def explained(error: Exception, folders: Sequence[Path]) -> InterfaceError | None:
    """What went wrong in a template of these folders while it was rendered; None if it was elsewhere."""
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if any(path.is_relative_to(folder) for folder in folders):
            message = f"{type(error).__name__}: {error}"
            return InterfaceError([_at(path, frame.lineno or 1, "template-error", message)])
    return None


def _names(folder: Path) -> Iterator[str]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not path.name.startswith("."):
            yield path.relative_to(folder).as_posix()


def _unused(path: Path, name: str, ours: set[str]) -> Diagnostic:
    close = get_close_matches(name, ours, n=1)
    advice = f"did you mean {close[0]}?" if close else f"ifgen's own are in {resources.templates()}"
    return Diagnostic(
        "unused-template", f"{path} replaces nothing: ifgen has no template {name}", help=advice
    )


def _at(path: Path, line: int, rule: str, message: str) -> Diagnostic:
    source = Source(path, path.read_text(encoding="utf-8", errors="replace"))
    start = sum(len(text) for text in source.text.splitlines(keepends=True)[: line - 1])
    end = start + len(source.line(line))
    return Diagnostic(rule, "this template cannot be used", Label(Span(source, start, end), message))
