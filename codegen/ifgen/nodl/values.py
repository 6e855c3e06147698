"""Values of parameters: which types there are, and whether a value is of one."""

from __future__ import annotations

import math
import re
from typing import Final, Literal, NamedTuple, cast

from ifgen.nodl.model import ParameterType, ParameterValue, ScalarValue
from ifgen.nodl.syntax.scalars import read_scalar
from ifgen.nodl.syntax.tree import ListNode, Node, ScalarNode

SCALARS: Final = ("bool", "int", "double", "string", "none")
ARRAYS: Final = ("bool_array", "int_array", "double_array", "string_array", "byte_array")
FIXED: Final = ("string_fixed", "int_array_fixed", "double_array_fixed", "string_array_fixed")
INT64: Final = (-(2**63), 2**63 - 1)
MAX_FIXED_SIZE: Final = 2**31 - 1

FIXED_SIZE: Final = r"(string|(?:int|double|string)_array)_fixed_([1-9][0-9]{0,18})"
"""Types with at most the given number of characters or elements."""
_NOUNS: Final = {
    "bool": "true or false",
    "int": "an integer of 64 bits",
    "double": "a number",
    "string": "a text",
    "byte": "an integer from 0 to 255",
}
_Base = Literal["bool", "int", "double", "string", "byte", "none"]


class BadValue(NamedTuple):
    """The part of a value that does not fit, and what it should be."""

    node: Node
    expected: str


def parameter_type(text: str) -> ParameterType | None:
    """The type that a text spells; None if it is none."""
    if text in SCALARS:
        return ParameterType(cast("_Base", text))
    if text in ARRAYS:
        return ParameterType(cast("_Base", text.removesuffix("_array")), array=True)
    match = re.fullmatch(FIXED_SIZE, text)
    if match is None:
        return None
    return ParameterType(
        cast("_Base", match[1].removesuffix("_array")), match[1].endswith("_array"), int(match[2])
    )


def spelled(type_: ParameterType) -> str:
    """A type as a document spells it."""
    size = "" if type_.fixed_size is None else f"_fixed_{type_.fixed_size}"
    return f"{type_.base}{'_array' if type_.array else ''}{size}"


def file_value(node: Node, type_: ParameterType) -> ParameterValue | BadValue:
    """The value in a parameter file: as `value`, but an integer is no double, which rclpy refuses, too."""
    return value(node, type_, of_file=True)


def value(node: Node, type_: ParameterType, *, of_file: bool = False) -> ParameterValue | BadValue:
    """The value of a type that a node says, or the part of it that is not of the type."""
    read_scalar_as = _scalar_of_file if of_file else scalar
    if not type_.array:
        found = read_scalar_as(node, type_.base)
        if isinstance(found, str) and type_.fixed_size is not None and len(found) > type_.fixed_size:
            return BadValue(node, f"a text of at most {type_.fixed_size} characters")
        return found
    if not isinstance(node, ListNode):
        return BadValue(node, f"a list: {_NOUNS[type_.base]} each")
    if type_.fixed_size is not None and len(node.items) > type_.fixed_size:
        return BadValue(node, f"a list of at most {type_.fixed_size} values")
    elements: list[ScalarValue] = []
    for item in node.items:
        element = read_scalar_as(item, type_.base)
        if isinstance(element, BadValue):
            return element
        elements.append(element)
    return bytes(cast("list[int]", elements)) if type_.base == "byte" else tuple(elements)


def read(node: Node) -> Node:
    """A value of a parameter as a node reads it in a parameter file: `1e5` is a number, `y` is true."""
    if not isinstance(node, ScalarNode) or node.written is None or node.value is None:
        return node
    return ScalarNode(read_scalar(node.written), node.span, node.plain)


def _scalar_of_file(node: Node, base: str) -> ScalarValue | BadValue:
    read_node = read(node)
    is_integer = isinstance(read_node, ScalarNode) and isinstance(read_node.value, int)
    if base == "double" and is_integer:
        return BadValue(node, "a number with a decimal point")
    return _of_base(read_node, base)


def scalar(node: Node, base: str) -> ScalarValue | BadValue:
    """The value that a node says for a parameter or an element of the type `base`.

    It is that of a parameter file if this has the type, else that of YAML 1.1: `y` is a text where one
    belongs.
    """
    found = _of_base(read(node), base)
    return _of_base(node, base) if isinstance(found, BadValue) else found


def _of_base(node: Node, base: str) -> ScalarValue | BadValue:
    found = node.value if isinstance(node, ScalarNode) else None
    match base, found:
        case "bool", bool():
            return found
        case "string", str():
            return found
        case "double", float():
            return found
        case "double", int() if not isinstance(found, bool):
            number = _as_float(found)
            return BadValue(node, "a number that a double can hold") if math.isinf(number) else number
        case "int", int() if not isinstance(found, bool) and INT64[0] <= found <= INT64[1]:
            return found
        case "byte", int() if not isinstance(found, bool) and 0 <= found <= 255:
            return found
        # JSON Schema takes 5.0 for an integer.
        case "byte", float() if 0 <= found <= 255 and found.is_integer():
            return int(found)
        case _:
            return BadValue(node, _NOUNS[base])


def _as_float(number: int) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf
