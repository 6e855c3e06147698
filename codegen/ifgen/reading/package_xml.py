"""The contents of a package.xml, and the mistakes in it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.reading import storage
from ifgen.reading.storage import read_limited, unreadable

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

NAME: Final = "package.xml"

_WHEN_RUN: Final = frozenset({"depend", "exec_depend", "test_depend"})

INTERFACES: Final = "rosidl_interface_packages"
"""The group of all packages with interfaces."""


@dataclass(frozen=True, slots=True)
class PackageXml:
    """The package's name, which is empty if it has none, and the place of the name.

    `dependencies` are the packages that it declares in one way or another, whatever the condition; with
    `INTERFACES` among them it is all packages of that group. `groups` are those that it belongs to.
    """

    name: str
    span: Span
    dependencies: frozenset[str] = field(default=frozenset(), repr=False)
    groups: frozenset[str] = field(default=frozenset(), repr=False)


def read(root: Path, problems: list[Diagnostic]) -> PackageXml | None:
    """The package.xml of a folder; None if there is none. `problems` say what is wrong with it."""
    path = root / NAME
    if not storage.is_file(path):
        return None
    source = Source(path, "", storage.revision(path))
    try:
        data = read_limited(path)
    except OSError as error:
        problems.append(unreadable(path, error))
        return PackageXml("", Span(source, 0, 0))
    source = Source(path, data.decode("utf-8", "replace"), storage.revision(path))
    try:
        document = _parsed(data)
    except _NoXmlError as error:
        problems.append(_bad(source, f"package.xml is not XML: {error}", error.line))
        return PackageXml("", Span(source, 0, 0))
    name = _text(document, "name")
    if not name:
        problems.append(_bad(source, "package.xml has no <name>", 1))
    match = re.search(rf"<name[^>]*>\s*({re.escape(name)})", source.text)
    start = match.start(1) if match else 0
    dependencies = (_words(element) for element in document if str(element.tag).endswith("depend"))
    groups = (_words(element) for element in document if element.tag == "member_of_group")
    span = Span(source, start, start + len(name))
    return PackageXml(name, span, frozenset(dependencies), frozenset(groups))


def texts(root: Path) -> dict[str, str] | None:
    """Version, description, maintainer, email and license; None if no package.xml can be read."""
    try:
        document = _parsed(read_limited(root / NAME))
    except (OSError, _NoXmlError):
        return None
    found = {tag: _text(document, tag) for tag in ("version", "description", "maintainer", "license")}
    maintainer = document.find("maintainer")
    email = maintainer.get("email", "") if maintainer is not None else ""
    return {**found, "email": email.strip()}


@dataclass(frozen=True, slots=True)
class Dependency:
    """A dependency as it is written: its tag, such as `exec_depend`, and attributes, such as a condition."""

    tag: str
    name: str
    attributes: tuple[tuple[str, str], ...] = ()


def declared(root: Path) -> tuple[Dependency, ...]:
    """The dependencies in the order of the file, without those that only a build needs."""
    try:
        document = _parsed(read_limited(root / NAME))
    except (OSError, _NoXmlError):
        return ()
    found = (
        Dependency(str(element.tag), _words(element), tuple(element.items()))
        for element in document
        if element.tag in _WHEN_RUN
    )
    return tuple(dict.fromkeys(dependency for dependency in found if dependency.name))


class _NoXmlError(Exception):
    """The text is no XML, from this line on."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


def _parsed(data: bytes) -> Element:
    # Parsing XML is worth its import only where there is a package.xml.
    from xml.etree import ElementTree

    try:
        return ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise _NoXmlError(error.msg, error.position[0]) from None
    except (ValueError, LookupError) as error:  # encodings that the parser does not know
        raise _NoXmlError(str(error), 1) from None


def _text(document: Element, tag: str) -> str:
    element = document.find(tag)
    return _words(element) if element is not None else ""


def _words(element: Element) -> str:
    return " ".join("".join(element.itertext()).split())


def _bad(source: Source, message: str, line: int) -> Diagnostic:
    start = sum(len(text) for text in source.text.splitlines(keepends=True)[: line - 1])
    return Diagnostic("bad-package-xml", message, Label(Span(source, start, start)))
