"""Explanations of mistakes in the types of an .idl file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten
from ifgen.idl.omg_tree import (
    BasicNode,
    DeclaratorNode,
    EnumNode,
    FixedNode,
    PathNode,
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
