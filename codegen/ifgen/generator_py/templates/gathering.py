"""Import lines of templates: each stands beside the text that needs it, and goes to the top of the file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from sys import stdlib_module_names
from typing import Final

from ifgen.generator_py.imports import Import, statements

_UNFORMATTED: Final = "# fmt: off"
# An import statement or the first line of code, at the left margin. Strings of many lines are skipped.
_AT_MARGIN: Final = re.compile(
    r"\n(?:from (?P<module>(?!__future__)\w[\w.]*) import (?:\((?P<lines>[\w\s,]+)\)|(?P<names>[\w, ]+))$"
    r"|import (?P<modules>[\w., ]+)$"
    r"""|(?P<head>[^\n"'#]*)\"{3}(?:\\.|[^\\])*?\"{3}"""
    rf"|(?P<code>@|async def |def |class |\w+(?:: [^\n]+)? = |{_UNFORMATTED}$))",
    re.MULTILINE | re.DOTALL,
)


@dataclass(slots=True)
class _Run:
    """Import statements with nothing but blank lines between them: where they are, and what they import."""

    start: int
    end: int
    imports: set[Import] = field(default_factory=set[Import])


def gathered(text: str, own_package: str) -> str:
    """The text with all its import statements at its top, each once, as ruff sorts them.

    There may be several runs of them at the top, with calls in between. A statement stays in its run, but the
    standard library belongs to the first. Whatever comes after the first line of code goes to the last one. A
    statement with a comment stays where it is.
    """
    text = f"\n{text}"
    top, scattered, code = _runs(text)
    if not top:
        if not scattered:
            return text[1:]
        top = [_Run(code, code)]
    for run in (*top[1:], *scattered):
        standard = {import_ for import_ in run.imports if _package(import_) in stdlib_module_names}
        top[0].imports |= standard
        run.imports -= standard
    for run in scattered:
        top[-1].imports |= run.imports
        run.imports = set()
    parts: list[str] = []
    end = 0
    for run in (*top, *scattered):
        lines = statements(run.imports, own_package)
        parts += [text[end : run.start], *(f"\n{line}" for line in lines)]
        end = run.end
    return "".join([*parts, text[end:]])[1:]


def _runs(text: str) -> tuple[list[_Run], list[_Run], int]:
    """The runs at the top, those after the first line of code, and where that is."""
    top: list[_Run] = []
    scattered: list[_Run] = []
    code = len(text)
    last = max(text.rfind("\nfrom "), text.rfind("\nimport "))
    for match in _AT_MARGIN.finditer(text):
        if match.start() > last:
            break
        if match["code"]:
            if top or match["code"] != _UNFORMATTED:  # which may hold for the whole file
                code = min(code, match.start())
        elif match["head"] is not None:
            if "=" in match["head"] and not match["head"].startswith(" "):
                code = min(code, match.start())
        elif match.start() > code:
            scattered.append(_Run(match.start(), match.end(), set(_imports(match))))
        else:
            if not top or text[top[-1].end : match.start()].strip():
                top.append(_Run(match.start(), match.end()))
            top[-1].end = match.end()
            top[-1].imports.update(_imports(match))
    return top, scattered, code


def _imports(match: re.Match[str]) -> Iterator[Import]:
    names = match["modules"] or match["lines"] or match["names"]
    for part in filter(None, map(str.strip, names.split(","))):
        name, _, spelling = part.partition(" as ")
        yield match["module"] or "", name, spelling or name


def _package(import_: Import) -> str:
    module, name, _ = import_
    return (module or name).partition(".")[0]
