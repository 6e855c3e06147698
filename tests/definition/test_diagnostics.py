"""ifgen's diagnostics of wrong interfaces: every case of cases/*.txt, word for word.

A case is a title (`====`), files (`----` and a path), and what is said (`>>>>`): place, severity, rule and message,
then other places and help, each indented. Places are `path:line:column-end`.
"""

from __future__ import annotations

from pathlib import Path

import ifgen
import pytest
from ifgen.definition.resolve import resolve
from ifgen.diagnostics import Diagnostic, InputError, Label
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

from .conftest import Case, cases

CASES = Path(__file__).parent / "cases"


def say(files: dict[str, str], folder: Path) -> str:
    """The diagnostics of files, in the format of the cases."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    try:
        packages = find_packages([folder])
        found = resolve(packages, SearchPath(packages)).warnings
    except InputError as error:
        found = error.diagnostics
    return "".join(_line(diagnostic, folder) for diagnostic in found)


def _line(diagnostic: Diagnostic, folder: Path) -> str:
    text = (
        f"{_place(diagnostic.primary, folder)}{diagnostic.severity}[{diagnostic.rule}] {diagnostic.message}\n"
    )
    if diagnostic.primary and diagnostic.primary.text:
        text += f"    here {diagnostic.primary.text}\n"
    for label in diagnostic.secondary:
        text += f"    at {_place(label, folder)}{label.text}\n"
    if diagnostic.help:
        text += f"    help {diagnostic.help}\n"
    return text.replace(str(folder), "FOLDER")


def _place(label: Label | None, folder: Path) -> str:
    if label is None:
        return ""
    span = label.span
    path = span.source.path.relative_to(folder).as_posix()
    return f"{path}:{span.line}:{span.column}-{span.column + span.end - span.start} "


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=case.title) for path in sorted(CASES.glob("*.txt")) for case in cases(path)],
)
def test_says(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All mistakes are reported at once, each at its place, with help."""
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(SearchPath, "places", lambda _: ["SHARE", "BUNDLED"])
    assert say(case.files, tmp_path) == case.said


def test_programs_may_catch_the_earlier_name() -> None:
    assert ifgen.InterfaceError is ifgen.InputError
