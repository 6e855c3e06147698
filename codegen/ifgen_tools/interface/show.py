"""The text that `interface show` prints: a definition, and below each field the definition of its message."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, TypeAlias

from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import Described

from ifgen_tools.interface.definitions import lines_of

Comments: TypeAlias = Literal["all", "own", "none"]
"""Which comments to show, with blank lines: all, those of the interface that was asked for, or none."""


def shown(described: Described, registry: Registry, comments: Comments) -> Iterator[str]:
    """The lines, those of nested messages with a tab for each level."""
    yield from _level(described, registry, comments, "")


def _level(described: Described, registry: Registry, comments: Comments, indent: str) -> Iterator[str]:
    below: Comments = "all" if comments == "all" else "none"
    for line in lines_of(described, registry):
        text = line.code if comments == "none" else line.text
        if text:
            yield indent + text
        elif comments != "none":
            yield ""
        if line.nested is not None:
            yield from _level(line.nested, registry, below, indent + "\t")
