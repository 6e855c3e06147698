"""The structs of an .idl file that are the parts of its interface, and checks of their places."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.definition.interfaces import Folder
from ifgen.definition.omg_idl import explain_structure as explain
from ifgen.definition.omg_idl.contents import CONSTANTS, SUFFIXES, Contents, Path, Placed
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source, Span
from ifgen.idl.omg_tree import ConstantDclNode, StructNode


def parts(
    contents: Contents, source: Source, package: str, folder: Folder, name: str, problems: FileProblems
) -> list[Placed[StructNode] | None]:
    """The structs of an interface's parts; None for one that is missing, which goes to `problems`."""
    expected = [name + suffix for suffix in SUFFIXES[folder]]
    found = contents.structs
    if len(found) != len(expected):
        problems.error(explain.wrong_number, source, found, folder, expected)
        return [None] * len(expected)
    for placed, wanted in zip(found, expected, strict=True):
        if placed.node.name != wanted:
            problems.error(explain.wrong_name, source, placed.node, wanted, expected)
            break
    for placed in found:
        if tuple(module.name for module in placed.path) != (package, folder):
            problems.error(explain.wrong_modules, source, placed, package, folder)
    return list(found)


def check_rest(contents: Contents, source: Source, problems: FileProblems) -> None:
    """Refuse what rosidl refuses, and warn of what it ignores: empty modules, lost constants, enums."""
    for module in contents.modules:
        if not module.definitions:
            problems.error(explain.empty_module, source, module)
        if module.annotations:
            problems.error(explain.annotated_module, source, module)
    known = {placed.node.name + CONSTANTS for placed in contents.structs}
    for placed in contents.constants:
        if not placed.path:
            problems.error(explain.outside, source, placed.node)
        elif placed.path[-1].name not in known:
            problems.warning(explain.lost_constant, source, placed, sorted(known))
    for constant, first in _same_constants(contents):
        problems.warning(explain.same_constant, source, constant, first)
    for enum in contents.enums:
        problems.warning(explain.lost_enum, Span(source, enum.start, enum.start + len(enum.name)))


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
