"""The contents of an .idl file without modules: structs, constants, typedefs, and unused definitions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, Generic, TypeAlias, TypeVar

from ifgen.definition.interfaces import Folder
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
