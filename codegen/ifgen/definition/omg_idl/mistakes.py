"""Explanations of mistakes in the structs, modules, constants and types of an .idl file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.definition.interfaces import Folder
from ifgen.definition.omg_idl.contents import SUFFIXES, Placed
from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten
from ifgen.idl.omg_tree import (
    BasicNode,
    ConstantDclNode,
    DeclaratorNode,
    EnumNode,
    FixedNode,
    ModuleNode,
    PathNode,
    StructNode,
    TypeNode,
    ValueNode,
)

_BASIC: Final = (
    *("boolean", "octet", "char", "float", "double", "string", "wstring", "short", "long"),
    *("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
)
_OTHER_SPELLINGS: Final = {
    "bool": "`boolean`",
    "byte": "`octet`",
    "float32": "`float`",
    "float64": "`double`",
    "int": "`int32`, which is `long` too",
    "uint": "`uint32`, which is `unsigned long` too",
    "str": "`string`",
    "bytes": "`sequence<octet>`, or `sequence<uint8>` for numbers",
    "time": "`builtin_interfaces::msg::Time`",
    "duration": "`builtin_interfaces::msg::Duration`",
    "Header": "`std_msgs::msg::Header`",
}
_REASONS: Final = {
    "long double": (
        "rosidl_generator_type_description cannot hash it, and rosidl_generator_c has no constants",
        "write `double`",
    ),
    "wchar": (
        "rosidl_generator_py cannot convert it: the process aborts, and for arrays there is no code at all",
        "write `wstring<1>`, or `uint16` for a code unit of UTF-16",
    ),
}


def _span(source: Source, node: TypeNode | ValueNode | PathNode) -> Span:
    return Span(source, node.start, node.end)


def _text(source: Source, node: TypeNode | ValueNode) -> str:
    return shorten(" ".join(source.text[node.start : node.end].split()))


def no_basic_type(source: Source, node: BasicNode) -> Diagnostic:
    """Say that a basic type of IDL can be parsed, but not sent."""
    reason, help = _REASONS[node.words]
    return Diagnostic(
        "idl-unsupported", f"`{node.words}` is not supported", Label(_span(source, node), reason), help=help
    )


def no_fixed(source: Source, node: FixedNode) -> Diagnostic:
    """Say that there are no fixed-point numbers."""
    label = Label(_span(source, node), "rosidl_parser refuses it")
    return Diagnostic("idl-unsupported", "`fixed` is not supported", label, help="write `double`")


def constant_type(source: Source, node: TypeNode) -> Diagnostic:
    """Say that a constant cannot be of a type."""
    message = f"a constant cannot be of type `{_text(source, node)}`"
    label = Label(_span(source, node), "rosidl_parser refuses it")
    return Diagnostic(
        "invalid-constant-type",
        message,
        label,
        help="constants are numbers, booleans, characters and strings",
    )


def wrong_path(source: Source, node: PathNode) -> Diagnostic:
    """Say that the name of a type has too few or too many parts."""
    package = shorten(node.parts[0]) if len(node.parts) > 1 else "package"
    name = shorten(node.parts[-1])
    return Diagnostic(
        "invalid-type",
        f"`{shorten(node.text)}` is not the name of a type",
        Label(_span(source, node), "rosidl_generator_type_description finds no such type"),
        help=f"write `{package}::msg::{name}`, or `{package}::srv::Name_Request` for a part of a service",
    )


def derived_type(source: Source, node: PathNode) -> Diagnostic:
    """Say that a message which rosidl derives is the type of a member."""
    what = "event message of a service"
    if not node.parts[-1].endswith("_Event"):
        what = "feedback message of an action"
    return Diagnostic(
        "invalid-type",
        f"the {what} cannot be the type of a member",
        Label(_span(source, node), "rosidl_generator_c includes a header for it that does not exist"),
        help="define a separate message for it",
    )


def nested_collection(source: Source, node: TypeNode, declarator: DeclaratorNode | None = None) -> Diagnostic:
    """Say that arrays and sequences hold no arrays and sequences."""
    span = _span(source, node)
    if declarator is not None and declarator.sizes:
        span = Span(source, declarator.start, source.text.index("]", declarator.sizes[-1].end) + 1)
    return Diagnostic(
        "invalid-type",
        "an array or a sequence cannot hold arrays or sequences",
        Label(span, "rosidl refuses it"),
        help="make it longer, or put the inner one into a separate message",
    )


def wrong_size(source: Source, node: ValueNode) -> Diagnostic:
    """Say that the size or the bound of something is no number."""
    help = "write a decimal number above 0"
    if node.kind == "name":
        help = f"{help}: rosidl_parser does not look up `{shorten(node.parts[0])}`"
    return Diagnostic(
        "invalid-size",
        f"`{_text(source, node)}` is not a size",
        Label(_span(source, node), "expected a whole number above 0"),
        help=help,
    )


def typedef_again(name: str, span: Span, first: Span) -> Diagnostic:
    """Say that two typedefs of one name differ."""
    return Diagnostic(
        "duplicate-typedef",
        f"typedef '{shorten(name)}' has two meanings",
        Label(span, "rosidl_parser has one scope for all of them, whatever module they are in"),
        (Label(first, "first defined here"),),
        "rename one of them",
    )


def typedef_of_typedef(source: Source, node: TypeNode, inner: PathNode) -> Diagnostic:
    """Say that rosidl looks a name up only once."""
    return Diagnostic(
        "invalid-type",
        f"`{_text(source, node)}` is a typedef of a typedef",
        Label(_span(source, node), "rosidl_parser looks up only the first of them"),
        (Label(_span(source, inner), "the other one"),),
        "write the type itself in one of the two places",
    )


def unknown_name(
    source: Source, node: PathNode, typedefs: Iterable[str], enums: Mapping[str, EnumNode], package: str
) -> Diagnostic:
    """Say that no typedef has a name."""
    name = node.text
    if name in enums:
        return is_enum(source, node, enums[name])
    label = Label(_span(source, node), "rosidl_parser knows no such typedef")
    if name in _OTHER_SPELLINGS:
        help = f"write {_OTHER_SPELLINGS[name]}"
    elif name[:1].isupper():
        help = f"write the whole name of a message, with its package: `{package}::msg::{shorten(name)}`"
    else:
        help = did_you_mean(name, [*typedefs, *_BASIC]) or (
            "a type is a basic type such as `double`, a typedef of this file, or `package::msg::Name`"
        )
    return Diagnostic("invalid-type", f"`{shorten(name)}` is not a type", label, help=help)


def is_enum(source: Source, node: PathNode, enum: EnumNode) -> Diagnostic:
    """Say that an enum is the type of a member."""
    return Diagnostic(
        "idl-unsupported",
        f"the enum `{shorten(enum.name)}` cannot be the type of a member",
        Label(_span(source, node), "rosidl generates nothing for enums, and finds no such type"),
        (Label(Span(source, enum.start, enum.start + len(enum.name)), "the enum"),),
        "write an integer type, and a constant for each value",
    )


def wstring_sequence(span: Span, bound: int) -> Diagnostic:
    """Say that a bound counts twice."""
    text = shorten(" ".join(span.source.text[span.start : span.end].split()))
    return Diagnostic(
        "wstring-sequence",
        f"rosidl applies the bound of `{text}` to the sequence, too",
        Label(span, f"rosidl reads `{text[:-1]}, {bound}>`, and so do we"),
        help="write that, or give the sequence its own bound",
        severity="warning",
    )


def integer_for_float(span: Span, is_float: bool) -> Diagnostic:
    """Say that a number lacks its point."""
    text = shorten(span.source.text[span.start : span.end])
    effect = f"rosidl's C code has `{text}f`, which does not compile"
    if not is_float:
        effect = "rosidl's Python class has an integer here, which it cannot send"
    return Diagnostic(
        "integer-for-float",
        f"`{text}` is an integer",
        Label(span, effect),
        help=f"write `{text}.0`",
        severity="warning",
    )


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
