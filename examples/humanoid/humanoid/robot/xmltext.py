"""XML elements from Python values, for both MJCF and URDF."""

from __future__ import annotations

from xml.etree import ElementTree


def add(parent: ElementTree.Element, tag: str, **attributes: object) -> ElementTree.Element:
    """Add a child element. Numbers are written so that they read back as the same numbers."""
    return ElementTree.SubElement(parent, tag, {key: _text(value) for key, value in attributes.items()})


def document(root: ElementTree.Element) -> str:
    """The element and everything below it as indented text."""
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _text(value: object) -> str:
    return " ".join(map(repr, value)) if isinstance(value, tuple) else str(value)
