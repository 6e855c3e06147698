"""Explanations of mistakes in the structs, modules and constants of an .idl file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ifgen.definition.interfaces import Folder
from ifgen.definition.omg_idl.contents import SUFFIXES, Placed
from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten
from ifgen.idl.omg_tree import ConstantDclNode, ModuleNode, StructNode

_ARTICLES: Final = {"msg": "a message", "srv": "a service", "action": "an action"}
_NUMBERS: Final = {1: "one struct", 2: "two structs", 3: "three structs"}


def _label(source: Source, node: StructNode | ModuleNode | ConstantDclNode, text: str = "") -> Label:
    return Label(Span(source, node.start, node.start + len(node.name)), text)


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(f"`{name}`" for name in names[:-1]), f"`{names[-1]}`")))


def wrong_number(
    source: Source, found: Sequence[Placed[StructNode]], folder: Folder, expected: Sequence[str]
) -> Diagnostic:
    """Say that a file has too few or too many structs for what its folder says it is."""
    labels = [_label(source, placed.node, "a struct") for placed in found[: len(expected) + 1]]
    place = labels[-1] if labels else Label(Span(source, 0, 0))
    help = f"{_ARTICLES[folder]} is {_NUMBERS[len(expected)]}, {_listed(expected)}"
    meant = next((kind for kind in ("srv", "action") if _is(kind, found)), None)
    if meant is not None:
        help = f"this is {_ARTICLES[meant]}: move the file to a folder named {meant}"
    elif len(found) > len(expected):
        help += "; write each message into its own file"
    return Diagnostic(
        "wrong-struct",
        f"{_ARTICLES[folder]} has {_NUMBERS[len(expected)]}, found {len(found) or 'none'}",
        place,
        tuple(labels[:-1]),
        help,
    )


def _is(kind: Folder, found: Sequence[Placed[StructNode]]) -> bool:
    suffixes = SUFFIXES[kind]
    return len(found) == len(suffixes) and all(
        placed.node.name.endswith(suffix) for placed, suffix in zip(found, suffixes, strict=True)
    )


def wrong_name(source: Source, node: StructNode, wanted: str, expected: Sequence[str]) -> Diagnostic:
    """Say that a struct is called otherwise than its file and its place ask for."""
    if node.name in expected:
        help = f"rosidl_parser requires this order: {_listed(expected)}"
    else:
        help = "the file's name is the type's: rename the struct or the file"
    return Diagnostic(
        "wrong-struct",
        f"expected a struct named '{wanted}', found '{shorten(node.name)}'",
        _label(source, node),
        help=help,
    )


def wrong_modules(source: Source, placed: Placed[StructNode], package: str, folder: Folder) -> Diagnostic:
    """Say that a struct is not in the modules of its package and folder."""
    for module, wanted in zip(placed.path, (package, folder), strict=False):
        if module.name != wanted:
            message = f"expected a module named '{wanted}', found '{shorten(module.name)}'"
            label = _label(source, module, "the modules are the package and the folder")
            break
    else:
        count = f"{placed.depth - 1 or 'no'} module{'s' * (placed.depth != 2)}"
        message = f"'{shorten(placed.node.name)}' is inside {count} in place of two"
        label = _label(source, placed.node)
    help = f"write `module {package} {{ module {folder} {{ struct {shorten(placed.node.name)} ...`"
    return Diagnostic("wrong-module", message, label, help=help)


def empty_module(source: Source, node: ModuleNode) -> Diagnostic:
    """Say that there is nothing in a module."""
    label = _label(source, node, "rosidl_parser refuses it")
    return Diagnostic("idl-syntax", f"module '{shorten(node.name)}' is empty", label, help="remove it")


def annotated_module(source: Source, node: ModuleNode) -> Diagnostic:
    """Say that rosidl_parser takes the annotation of a module for its name."""
    annotation = node.annotations[0]
    return Diagnostic(
        "idl-unsupported",
        "a module cannot have annotations",
        Label(
            Span(source, annotation.start, annotation.end),
            f"rosidl_parser then names the module '{shorten(annotation.name)}'",
        ),
        (_label(source, node, "its name"),),
        "put the annotation before the struct",
    )


def empty_struct(source: Source, node: StructNode) -> Diagnostic:
    """Say that a struct has no members."""
    return Diagnostic(
        "idl-syntax",
        f"struct '{shorten(node.name)}' is empty",
        _label(source, node, "rosidl_parser refuses it"),
        help="write `uint8 structure_needs_at_least_one_member;` into it, which rosidl hides",
    )


def outside(source: Source, node: ConstantDclNode) -> Diagnostic:
    """Say that a constant is in no module."""
    return Diagnostic(
        "wrong-module",
        f"constant '{shorten(node.name)}' is outside of all modules",
        _label(source, node, "rosidl_parser fails on it"),
        help="constants are in a module beside the struct: `module Name_Constants { ... };`",
    )


def lost_constant(source: Source, placed: Placed[ConstantDclNode], known: Sequence[str]) -> Diagnostic:
    """Say that the module of a constant is not called after a struct."""
    return Diagnostic(
        "lost-constant",
        f"constant '{shorten(placed.node.name)}' belongs to no struct",
        _label(source, placed.node, "rosidl ignores it, and so do we"),
        (_label(source, placed.path[-1], "its module"),),
        f"name its module {' or '.join(f'`{name}`' for name in known[:3])}" if known else None,
        "warning",
    )


def lost_enum(span: Span) -> Diagnostic:
    """Say that an enum has no effect."""
    return Diagnostic(
        "lost-enum",
        "rosidl generates nothing for an enum",
        Label(span, "it ignores this, and so do we"),
        help="write a constant for each value into the module of a struct's constants",
        severity="warning",
    )


def same_constant(source: Source, node: ConstantDclNode, first: ConstantDclNode) -> Diagnostic:
    """Say that rosidl_parser takes two constants for one."""
    return Diagnostic(
        "same-constant",
        f"two modules have the same constant '{shorten(node.name)}'",
        _label(source, node, "rosidl_parser assigns this one to the first module"),
        (_label(source, first, "the first"),),
        "give one of the two another comment: then rosidl keeps them apart",
        "warning",
    )
