"""What a package.xml says, and what is wrong with one."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.text_files import unreadable

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def declared_name(root: Path, problems: list[Diagnostic]) -> tuple[str, Span] | None:
    """The name in the package.xml of a folder and its place; None if there is none.

    Where the file has no name it is empty, and `problems` say why.
    """
    manifest = root / "package.xml"
    if not manifest.is_file():
        return None
    source, name = Source(manifest, ""), ""
    try:
        data = manifest.read_bytes()
    except OSError as error:
        problems.append(unreadable(manifest, error))
    else:
        source = Source(manifest, data.decode("utf-8", "replace"))
        try:
            name = _text(_parsed(data), "name")
            if not name:
                problems.append(_bad(source, "package.xml has no <name>", 1))
        except _NoXmlError as error:
            problems.append(_bad(source, f"package.xml is not XML: {error}", error.line))
    match = re.search(rf"<name[^>]*>\s*({re.escape(name)})", source.text)
    start = match.start(1) if match else 0
    return name, Span(source, start, start + len(name))


def texts(root: Path) -> dict[str, str] | None:
    """Version, description, maintainer, email and license; None if no package.xml can be read."""
    try:
        document = _parsed((root / "package.xml").read_bytes())
    except (OSError, _NoXmlError):
        return None
    found = {tag: _text(document, tag) for tag in ("version", "description", "maintainer", "license")}
    maintainer = document.find("maintainer")
    email = maintainer.get("email", "") if maintainer is not None else ""
    return {**found, "email": email.strip()}


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
    return " ".join("".join(element.itertext()).split()) if element is not None else ""


def _bad(source: Source, message: str, line: int) -> Diagnostic:
    start = sum(len(text) for text in source.text.splitlines(keepends=True)[: line - 1])
    return Diagnostic("bad-package-xml", message, Label(Span(source, start, start)))
