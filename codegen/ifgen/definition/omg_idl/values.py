"""The values of constants, sizes and annotations, from their literals, as rosidl_parser reads them.

rosidl_parser gives a constant any value that its literal has; only the code generated from it fails. Here a
value must have the type of the constant.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Iterable
from typing import Final, cast

from ifgen.definition.interfaces import Plain, Scalar
from ifgen.definition.literals import INTEGER_RANGES, BadValue, check_count, read_idl
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    StringType,
    UnboundedSequence,
)
from ifgen.diagnostics import shorten
from ifgen.idl.omg_tree import ValueNode

_DECIMAL: Final = re.compile(r"0|[1-9][0-9]*")
_SMALL_DECIMAL: Final = 4000
"""Digits of a number that Python reads at all."""
_UNPRINTABLE: Final = re.compile("[\n\r\0\ud800-\udfff]")
_LARGEST_CHAR: Final = 255
_LARGEST_ASCII: Final = 127
_WORDS: Final = {"true": "TRUE", "false": "FALSE"}
_NOT_FINITE: Final = {"nan", "inf", "infinity"}


def size_of(node: ValueNode) -> int | None:
    """The number of elements or characters that a literal says; None if it is no whole number above 0."""
    if node.kind != "integer" or node.sign not in ("", "+"):
        return None
    (digits,) = node.parts
    return int(digits) if _is_decimal(digits) and digits != "0" else None


def plain_value(node: ValueNode) -> Plain:
    """The value of a literal; a single name stands for a string, as in rosidl.

    Raises BadValue if there is none.
    """
    if node.sign and (node.sign == "~" or node.kind not in ("integer", "real", "fixed")):
        raise BadValue(f"rosidl_parser ignores the `{node.sign}`", "write the resulting value")
    first = node.parts[0]
    match node.kind:
        case "integer":
            if not _is_decimal(first):
                raise BadValue("rosidl_parser reads only decimal numbers", _decimal_advice(first, node.sign))
            return _negated(int(first), node.sign)
        case "real" | "fixed":
            return _finite(_negated(float(first.rstrip("dD")), node.sign))
        case "boolean":
            return first == "TRUE"
        case "text":
            return "".join([read_idl(part[1:-1]) for part in node.parts])
        case "wide text":
            return "".join([read_idl(part[2:-1], wide=True) for part in node.parts])
        case "character":
            raise BadValue("rosidl_parser reads no character literals", _character_advice(first))
        case "name":
            if "::" in first:
                raise BadValue("rosidl_parser does not look up names", "write the value itself")
            return first


def _is_decimal(digits: str) -> bool:
    return _DECIMAL.fullmatch(digits) is not None and len(digits) <= _SMALL_DECIMAL


def _decimal_advice(written: str, sign: str) -> str | None:
    base = 16 if written[1:2] in ("x", "X") else 8
    try:
        return f"write {shorten(sign + str(int(written, base)))}"
    except ValueError:
        return None


def _character_advice(literal: str) -> str | None:
    character = literal.lstrip("L")[1:-1]
    return f"write its number, {ord(character)}" if len(character) == 1 else "write its number"


def _negated(value: int | float, sign: str) -> int | float:
    return -value if sign == "-" else value


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise BadValue("`nan` and `inf` cannot be written in an interface", rule="not-finite")
    return value


def constant_value(node: ValueNode, type_: BasicType | StringType) -> Scalar:
    """The value of a constant. Raises BadValue if the literal has none of this type."""
    return _scalar(plain_value(node), type_, is_name=node.kind == "name")


def default_value(node: ValueNode, type_: FieldType) -> Scalar | tuple[Scalar, ...]:
    """The default that a literal stands for in a member of this type. Raises BadValue if it is invalid.

    The default of an array or a sequence is a string that holds a Python tuple: `"(1, 2, 3)"`.
    """
    match type_:
        case NamespacedType():
            raise _nested()
        case Array() | BoundedSequence() | UnboundedSequence():
            return _collection(plain_value(node), type_)
        case BasicType("char"):
            value = plain_value(node)
            if isinstance(value, int) and value > _LARGEST_ASCII:
                raise BadValue(f"rosidl's Python class refuses a default above {_LARGEST_ASCII}")
            return _scalar(value, type_, is_name=node.kind == "name")
        case _:
            return _scalar(plain_value(node), type_, is_name=node.kind == "name")


def _nested() -> BadValue:
    return BadValue("a member of a message type cannot have a default value", rule="nested-default")


def _scalar(value: Plain, type_: BasicType | StringType, *, is_name: bool = False) -> Scalar:
    if is_name and isinstance(type_, BasicType):
        raise _name_is_no_value(str(value), type_)
    if not isinstance(type_, BasicType):
        return _text(value, type_)
    match type_.typename:
        case "boolean":
            return _boolean(value)
        case "float" | "double":
            return _float(value)
        case "octet":
            return bytes([_integer(value, "octet")])
        case "char":
            return chr(_character(value))
        case typename:
            return _integer(value, typename)


def _name_is_no_value(name: str, type_: BasicType) -> BadValue:
    if type_.typename in ("float", "double") and name.lower() in _NOT_FINITE:
        return BadValue("`nan` and `inf` cannot be written in an interface", rule="not-finite")
    if type_.typename == "boolean" and name.lower() in _WORDS:
        return BadValue("rosidl_parser reads this as a string", f"write `{_WORDS[name.lower()]}`")
    return BadValue("rosidl_parser does not look up names", "write the value itself")


def _boolean(value: Plain) -> bool:
    if isinstance(value, bool):
        return value
    if isinstance(value, int) and value in (0, 1):
        return bool(value)
    raise BadValue("expected `TRUE` or `FALSE`")


def _integer(value: Plain, typename: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise BadValue("expected an integer such as `5` or `-5`")
    low, high = INTEGER_RANGES[typename]
    if not low <= value <= high:
        raise BadValue(f"out of range: must be between {low} and {high}")
    return value


def _float(value: Plain) -> float:
    if isinstance(value, bool | str):
        raise BadValue("expected a number such as `1.5`, `-2.0` or `1e-3`")
    try:
        return _finite(float(value))
    except OverflowError:
        return _finite(math.inf)


def _character(value: Plain) -> int:
    if isinstance(value, str) and len(value) == 1:
        raise BadValue("expected the number of a character", f"write {ord(value)}")
    if isinstance(value, bool) or not isinstance(value, int):
        raise BadValue("expected the number of a character, such as `65` for `A`")
    if not 0 <= value <= _LARGEST_CHAR:
        raise BadValue(f"out of range: must be between 0 and {_LARGEST_CHAR}")
    return value


def _text(value: Plain, type_: StringType) -> str:
    if not isinstance(value, str):
        raise BadValue('expected a string such as `"text"`')
    if _UNPRINTABLE.search(value):
        raise BadValue(
            "rosidl's code cannot hold a line break, a NUL or half of a surrogate pair in a string",
            rule="unportable-string",
        )
    if isinstance(type_, BoundedString | BoundedWString) and len(value) > type_.maximum_size:
        raise BadValue(f"longer than the bound of {type_.maximum_size} characters")
    return value


def _collection(value: Plain, type_: Array | BoundedSequence | UnboundedSequence) -> tuple[Scalar, ...]:
    element = type_.value_type
    if isinstance(element, NamespacedType):
        raise _nested()
    elements = _python_tuple(value)
    check_count(len(elements), type_)
    return tuple([_element(item, element) for item in elements])


def _element(item: Plain, type_: BasicType | StringType) -> Scalar:
    try:
        return _scalar(item, type_)
    except BadValue as error:
        raise BadValue(f"`{_shown(item)}`: {error.message}", error.help, error.rule) from None


def _shown(item: object) -> str:
    try:
        return shorten(repr(item), 20)
    except ValueError:  # an integer of more digits than Python writes
        return "..."


def _python_tuple(value: Plain) -> tuple[Plain, ...]:
    """The elements that rosidl_generator_py finds in a string."""
    help = 'write `"(1, 2, 3)"`, or `"(1,)"` for a single element'
    if not isinstance(value, str):
        raise BadValue("the default of an array is a string that holds a Python tuple", help)
    try:
        with warnings.catch_warnings(action="ignore"):
            found: object = ast.literal_eval(value)
    except (ValueError, SyntaxError, MemoryError, RecursionError, TypeError):
        raise BadValue("rosidl_generator_py cannot read this as a Python tuple", help) from None
    if not isinstance(found, tuple | list):
        raise BadValue("expected a Python tuple", help)
    elements: list[Plain] = []
    for item in cast("Iterable[object]", found):
        if not isinstance(item, bool | int | float | str):
            raise BadValue(f"`{_shown(item)}` is neither a number nor a string", help)
        elements.append(item)
    return tuple(elements)
