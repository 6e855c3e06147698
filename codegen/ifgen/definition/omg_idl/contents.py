"""The contents of an .idl file without modules: structs, constants, typedefs, and unused definitions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, Generic, TypeAlias, TypeVar

from ifgen.definition.interfaces import Folder
from ifgen.definition.omg_idl import mistakes
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source, Span
from ifgen.idl.omg_tree import (
    ConstantDclNode,
    EnumNode,
    IdlNode,
    IdlTree,
    IncludeNode,
    ModuleNode,
    StructNode,
    TypedefNode,
)

CONSTANTS: Final = "_Constants"
"""The suffix of a module for a struct's constants: `Pose_Constants`."""

SUFFIXES: Final[dict[Folder, tuple[str, ...]]] = {
    "msg": ("",),
    "srv": ("_Request", "_Response"),
    "action": ("_Goal", "_Result", "_Feedback"),
}
"""The suffixes of an interface's structs, in their order."""

NodeT = TypeVar("NodeT")
Path: TypeAlias = tuple[ModuleNode, ...]


@dataclass(frozen=True, slots=True)
class Placed(Generic[NodeT]):
    """A definition, its modules, the outermost first, and their number.

    Of more than four modules those before the last are left out.
    """

    node: NodeT
    path: Path
    depth: int


@dataclass(frozen=True, slots=True)
class Contents:
    """The definitions of a file; structs and constants in rosidl_parser's order, the deepest ones first."""

    structs: list[Placed[StructNode]] = field(default_factory=list[Placed[StructNode]])
    constants: list[Placed[ConstantDclNode]] = field(default_factory=list[Placed[ConstantDclNode]])
    typedefs: list[TypedefNode] = field(default_factory=list[TypedefNode])
    enums: list[EnumNode] = field(default_factory=list[EnumNode])
    includes: list[IncludeNode] = field(default_factory=list[IncludeNode])
    modules: list[ModuleNode] = field(default_factory=list[ModuleNode])

    def starts(self) -> list[int]:
        """The offsets where constants, typedefs, enums and the members of structs start, in order."""
        members = (d.start for placed in self.structs for m in placed.node.members for d in m.declarators)
        constants = (placed.node.start for placed in self.constants)
        typedefs = (node.declarator.start for node in self.typedefs)
        return sorted((*members, *constants, *typedefs, *(node.start for node in self.enums)))

    def constants_of(self, struct: str) -> Iterator[Placed[ConstantDclNode]]:
        """The constants of a struct, in whatever place its module is."""
        return (
            placed for placed in self.constants if placed.path and placed.path[-1].name == struct + CONSTANTS
        )


def contents_of(tree: IdlTree) -> Contents:
    """Walk the modules, however deep they are."""
    found = Contents()
    pending: list[tuple[Iterator[IdlNode], Path]] = [(iter(tree.definitions), ())]
    while pending:
        definitions, path = pending[-1]
        node = next(definitions, None)
        match node:
            case None:
                pending.pop()
            case ModuleNode():
                found.modules.append(node)
                pending.append((iter(node.definitions), (*path[:3], node)))
            case StructNode():
                found.structs.append(Placed(node, path, len(pending)))
            case ConstantDclNode():
                found.constants.append(Placed(node, path, len(pending)))
            case TypedefNode():
                found.typedefs.append(node)
            case EnumNode():
                found.enums.append(node)
            case IncludeNode():
                found.includes.append(node)
    found.structs.sort(key=_depth)
    found.constants.sort(key=_depth)
    return found


def _depth(placed: Placed[NodeT]) -> int:
    return -placed.depth


def parts_of(
    contents: Contents, source: Source, package: str, folder: Folder, name: str, problems: FileProblems
) -> list[Placed[StructNode] | None]:
    """The structs of an interface's parts; None for one that is missing, which goes to `problems`."""
    expected = [name + suffix for suffix in SUFFIXES[folder]]
    found = contents.structs
    if len(found) != len(expected):
        problems.error(mistakes.wrong_number, source, found, folder, expected)
        return [None] * len(expected)
    for placed, wanted in zip(found, expected, strict=True):
        if placed.node.name != wanted:
            problems.error(mistakes.wrong_name, source, placed.node, wanted, expected)
            break
    for placed in found:
        if tuple(module.name for module in placed.path) != (package, folder):
            problems.error(mistakes.wrong_modules, source, placed, package, folder)
    return list(found)


def check_rest(contents: Contents, source: Source, problems: FileProblems) -> None:
    """Refuse what rosidl refuses, and warn of what it ignores: empty modules, lost constants, enums."""
    for module in contents.modules:
        if not module.definitions:
            problems.error(mistakes.empty_module, source, module)
        if module.annotations:
            problems.error(mistakes.annotated_module, source, module)
    known = {placed.node.name + CONSTANTS for placed in contents.structs}
    for placed in contents.constants:
        if not placed.path:
            problems.error(mistakes.outside, source, placed.node)
        elif placed.path[-1].name not in known:
            problems.warning(mistakes.lost_constant, source, placed, sorted(known))
    for constant, first in _same_constants(contents):
        problems.warning(mistakes.same_constant, source, constant, first)
    for enum in contents.enums:
        problems.warning(mistakes.lost_enum, Span(source, enum.start, enum.start + len(enum.name)))


def _same_constants(contents: Contents) -> Iterator[tuple[ConstantDclNode, ConstantDclNode]]:
    """Constants of different modules that rosidl_parser, which compares what they say, takes for one."""
    known: dict[object, tuple[ConstantDclNode, Path]] = {}
    for placed in contents.constants:
        node = placed.node
        said = [
            (a.name, a.value and a.value[:3], [(p.name, p.value[:3]) for p in a.parameters])
            for a in node.annotations
        ]
        key = repr((node.name, node.type[:-2], node.value[:3], said))
        first, path = known.setdefault(key, (node, placed.path))
        if path != placed.path:
            yield node, first
