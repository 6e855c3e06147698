"""Fixes that follow from a finding alone: package.xml, CMakeLists.txt and `pkg::Type` in interfaces.

A fix adds what the finding misses, or replaces the spelling of a type. The rest of the file stays as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final, TypeAlias

from ifgen.diagnostics import Diagnostic, Span
from ifgen.reading import package_xml, storage
from ifgen.reading.listed_file import GENERATE

_COMMENT: Final = re.compile(r"<!--.*?-->", re.DOTALL)
_DEPEND: Final = re.compile(r"</\w*depend\s*>")
_END: Final = re.compile(r"[ \t]*(<export\b|</package\s*>)")
_NAME: Final = re.compile(r"[A-Za-z]\w*")
_COLONS: Final = re.compile(r"[a-z]\w*(?:::msg)?::[A-Z]\w*")
# In CMake: strings, comments and bracket arguments, inside which nothing counts.
_SKIPPED: Final = re.compile(r'"(?:\\.|[^"\\])*"|#?\[(=*)\[.*?\]\1\]|#[^\n]*', re.DOTALL)

_CALL: Final = re.compile(rf"(?i)\b{GENERATE}\s*\((?P<arguments>[^()]*)\)")

_Key: TypeAlias = tuple[str, int]
"""The name of a package, or a place in the file counted from its end: fixes are made in this order."""
Fix: TypeAlias = Callable[[str], str]
"""From a text with plain line ends to the fixed one."""


def fixed(found: Iterable[Diagnostic]) -> dict[Path, tuple[str, str]]:
    """The files with fixes for what was found: their texts before and after."""
    fixes: dict[Path, dict[_Key, Fix]] = {}
    for diagnostic in found:
        for path, key, fix in _fixes(diagnostic):
            fixes.setdefault(path, {}).setdefault(key, fix)
    return _made(fixes)


def declaring(root: Path, name: str) -> dict[Path, tuple[str, str]]:
    """The lists of a package that take one more dependency: their texts before and after."""
    makers: dict[str, Fix] = {
        package_xml.NAME: _adding_to_xml(f"<depend>{name}</depend>"),
        "CMakeLists.txt": _adding_to_cmake(name),
    }
    there = {root / file: fix for file, fix in makers.items() if storage.is_file(root / file)}
    return _made({path: {(name, 0): fix} for path, fix in there.items()})


def _made(fixes: dict[Path, dict[_Key, Fix]]) -> dict[Path, tuple[str, str]]:
    """The files that fixes change: their texts before and after."""
    texts: dict[Path, tuple[str, str]] = {}
    for path, by_place in fixes.items():
        before = _read(path)
        crlf = before.count("\r\n")
        if crlf not in {0, before.count("\n")}:
            continue  # both kinds of line ends: whichever a new line gets is a guess
        text = before.replace("\r\n", "\n")
        # From the end to the start, so that places stay where they are.
        for key in sorted(by_place):
            text = by_place[key](text)
        after = text.replace("\n", "\r\n") if crlf else text
        if after != before:
            texts[path] = before, after
    return texts


def _read(path: Path) -> str:
    return storage.read_bytes(path).decode()


def _fixes(diagnostic: Diagnostic) -> Iterable[tuple[Path, _Key, Fix]]:
    if diagnostic.primary is None:
        return
    span = diagnostic.primary.span
    word = span.source.text[span.start : span.end]
    match diagnostic.rule:
        case "undeclared-dependency":
            if (name := _NAME.search(word)) is None:
                return
            for label in diagnostic.secondary:
                path = label.span.source.path
                if path.name == package_xml.NAME:
                    yield path, (name[0], 0), _adding_to_xml(f"<depend>{name[0]}</depend>")
                else:
                    yield path, (name[0], 0), _adding_to_cmake(name[0])
        case "not-in-group":
            element = f"<member_of_group>{package_xml.INTERFACES}</member_of_group>"
            yield span.source.path.with_name(package_xml.NAME), ("", 0), _adding_to_xml(element)
        case "invalid-type" if _COLONS.fullmatch(word.partition("[")[0]):
            slashes = word.replace("::msg::", "/").replace("::", "/")
            yield span.source.path, ("", -span.start), _replacing(span, word, slashes)
        case _:
            pass


def _replacing(span: Span, old: str, new: str) -> Fix:
    def fix(text: str) -> str:
        if text[span.start : span.end] != old:
            return text
        return text[: span.start] + new + text[span.end :]

    return fix


def _adding_to_xml(element: str) -> Fix:
    def fix(text: str) -> str:
        plain = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text)
        if element in plain:
            return text
        depends = list(_DEPEND.finditer(plain))
        if depends and "depend" in element:
            at = depends[-1].end()
            line = plain[plain.rfind("\n", 0, at) + 1 : at]
            return f"{text[:at]}\n{_indent(line)}{element}{text[at:]}"
        end = _END.search(plain)
        if end is None:
            return text
        margin = _indent(end[0]) or "  "
        start = "" if plain[: end.start()].endswith("\n") or not end.start() else "\n"
        return f"{text[: end.start()]}{start}{margin}{element}\n{text[end.start() :]}"

    return fix


def _adding_to_cmake(name: str) -> Fix:
    def fix(text: str) -> str:
        plain = _SKIPPED.sub(lambda skipped: re.sub(r"[^\n]", " ", skipped[0]), text)
        calls = list(_CALL.finditer(plain))
        if len(calls) != 1:
            return text  # it is not certain which one, or it is in another file
        start, end = calls[0].span("arguments")
        _, keyword, passed = plain[start:end].partition("DEPENDENCIES")
        if not keyword:
            head = text[:end].rstrip()
            separator = f"\n{_indent(_line(text, calls[0].start()))}  " if "\n" in text[start:end] else " "
            fixed = f"{head}{separator}DEPENDENCIES {name}{text[len(head) :]}"
        elif name not in passed.split():
            at = start + plain[start:end].index(keyword) + len(keyword)
            gap = passed[: len(passed) - len(passed.lstrip())] or " "
            fixed = f"{text[:at]}{gap}{name}{text[at:]}"
        else:
            fixed = text
        margin = _line(text, calls[0].start())
        if re.search(rf"(?i)\bfind_package\s*\(\s*{name}\b", plain) or margin.strip():
            return fixed
        at = calls[0].start() - len(margin)
        return f"{fixed[:at]}{margin}find_package({name} REQUIRED)\n{fixed[at:]}"

    return fix


def _line(text: str, end: int) -> str:
    """The line that a place is in, up to that."""
    return text[text.rfind("\n", 0, end) + 1 : end]


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip(" \t"))]
