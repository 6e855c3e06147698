"""The tree of one file: its parts and their definitions as written, with the place of each word.

Offsets count characters of the file's text. Nothing here has been looked into: a type may not exist, a name
may be invalid and a value may not fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from ifgen.diagnostics import Diagnostic, Source


class FieldNode(NamedTuple):
    """`TYPE NAME [DEFAULT]`. `value` is None where there is no default value.

    `optional` is whether `@optional` stands before it.
    """

    type_text: str
    type_start: int
    name: str
    name_start: int
    value: str | None
    value_start: int
    comments: Sequence[str]
    optional: bool = False


class ConstantNode(NamedTuple):
    """`TYPE NAME=VALUE`. The value may be empty."""

    type_text: str
    type_start: int
    name: str
    name_start: int
    value: str
    value_start: int
    comments: Sequence[str]


DefinitionNode: TypeAlias = FieldNode | ConstantNode


class PartNode(NamedTuple):
    """A message, or what stands between the `---` lines of a service or an action.

    `optionals` says where each `@optional` starts.
    """

    comments: Sequence[str]
    definitions: Sequence[DefinitionNode]
    optionals: Sequence[int] = ()


@dataclass(frozen=True, slots=True)
class InterfaceTree:
    """One file. `problems` says what is wrong with its lines; `unexplained` counts the bad ones beyond."""

    source: Source
    parts: tuple[PartNode, ...]
    problems: tuple[Diagnostic, ...] = ()
    unexplained: int = 0
