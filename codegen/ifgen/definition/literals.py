"""The values of constants and defaults, from their text.

Three steps, as in rosidl: rosidl_adapter reads the text; a string then travels through an .idl file, which
interprets its backslashes twice; an array of strings travels as the text of a Python tuple, which interprets
them once.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from typing import Final

from ifgen.definition.interfaces import Scalar
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

_ESCAPE: Final = re.compile(r"""\\(?:[ntvbrfa\\?'"]|[0-7]{1,3}|x[0-9a-fA-F]{1,2})""")
_WIDE_ESCAPE: Final = re.compile(rf"{_ESCAPE.pattern}|\\u[0-9a-fA-F]{{1,4}}")
_CHARACTERS: Final = {
    **{"n": "\n", "t": "\t", "v": "\v", "b": "\b", "r": "\r", "f": "\f", "a": "\a"},
    **{"\\": "\\", "'": "'", '"': '"', "?": "\\?"},
}
_SECOND_ESCAPE: Final = re.compile(r'\\(["\\])')
_FOURFOLD: Final = "rosidl interprets backslashes twice: write four for one"
_CHARACTER: Final = "write the character itself; in an array of strings rosidl takes nothing but ASCII"
_ODD_BACKSLASHES: Final = re.compile(r'(?<!\\)(?:\\\\)*\\(?:"|\Z)')


class BadValue(Exception):
    """A text that is no value of its type: why, what to do about it, and which rule it breaks."""

    def __init__(self, message: str, help: str | None = None, rule: str = "invalid-value") -> None:
        super().__init__(message)
        self.message = message
        self.help = help
        self.rule = rule


def carried(text: str) -> str:
    """The value that a string has when it arrives; BadValue if rosidl cannot carry it."""
    if "\\" not in text:
        return text
    written = _unescape(text)
    if "\n" in written or "\r" in written:
        raise _not_carried("rosidl_parser fails on a line break in a string")
    if _ODD_BACKSLASHES.search(written):
        raise _not_carried("rosidl_parser does not find the end of a string with a backslash here", _FOURFOLD)
    return _read_back(written)


def carried_in_array(values: list[str]) -> tuple[str, ...]:
    """The values that an array of strings has when it arrives; BadValue if rosidl cannot carry them."""
    if all("\\" not in value and value.isascii() for value in values):
        return tuple(values)
    written = repr(tuple(values)).replace("\\", "\\\\")
    try:
        with warnings.catch_warnings(action="ignore"):
            arrived = ast.literal_eval(_read_back(written))
    except (ValueError, SyntaxError):
        raise _not_carried("rosidl_generator_py cannot read this backslash in an array of strings") from None
    return tuple(arrived)


def is_carried(comment: str) -> bool:
    """Whether a comment line or a unit arrives at all; an escape in it may still change it."""
    try:
        carried(comment)
    except BadValue:
        return False
    return True


def interpreted(text: str) -> str | None:
    """The text with its escapes interpreted once, as the source code of most languages has them."""
    try:
        return _unescape(text).encode("latin-1").decode("utf-8")
    except (BadValue, UnicodeError):
        return None


def _read_back(written: str) -> str:
    """The value that rosidl_parser reads from the string that rosidl_adapter writes into an .idl file."""
    try:
        text = written.encode("latin-1").decode("utf-8")
    except UnicodeError:
        raise _not_carried("rosidl cannot write or read this character here", _CHARACTER) from None
    return read_idl(text)


def read_idl(text: str, *, wide: bool = False) -> str:
    r"""The value that rosidl_parser reads from the characters between the quotes of an .idl string.

    Only a wide one (`L"..."`) knows `\uXXXX`. BadValue where rosidl fails.
    """
    escape = _WIDE_ESCAPE if wide else _ESCAPE
    return _SECOND_ESCAPE.sub(r"\1", escape.sub(_escaped_character, text))


def _escaped_character(match: re.Match[str]) -> str:
    escape = match[0]
    if escape[1] in "xu":
        digits = 2 if escape[1] == "x" else 4
        if len(escape) < 2 + digits:
            raise _not_carried(f"rosidl_parser needs {digits} hexadecimal digits after `\\{escape[1]}`")
        return chr(int(escape[2:], 16))
    return _CHARACTERS[escape[1]] if escape[1] in _CHARACTERS else chr(int(escape[1:], 8))


def _unescape(text: str) -> str:
    """Interpret the escapes of a Python string literal; raw bytes above 127 become Latin-1 characters."""
    try:
        with warnings.catch_warnings(action="ignore"):
            return text.encode().decode("unicode_escape")
    except UnicodeDecodeError:
        raise _not_carried("rosidl_adapter cannot read this backslash", _FOURFOLD) from None


def _not_carried(message: str, help: str | None = None) -> BadValue:
    return BadValue(message, help, rule="unportable-string")


INTEGER_RANGES: Final = {
    "octet": (0, 2**8 - 1),
    "int8": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
}
_SPACES: Final = re.compile(" *")
_BOOLEANS: Final = {"true": True, "1": True, "false": False, "0": False}


def default_value(text: str, type_: FieldType) -> Scalar | tuple[Scalar, ...]:
    """The default that `text` stands for in a field of this type. Raises BadValue if it is invalid."""
    match type_:
        case NamespacedType():
            raise BadValue("a field of a message type cannot have a default value", rule="nested-default")
        case Array() | BoundedSequence() | UnboundedSequence():
            return _array(text, type_)
        case _:
            return scalar_value(text, type_)


def scalar_value(text: str, type_: BasicType | StringType) -> Scalar:
    """The value of a constant, or of a default that is not an array.

    Raises BadValue if the text is invalid.
    """
    if isinstance(type_, BasicType):
        return _basic_value(text, type_)
    return _without_nul(carried(_string_text(text, type_)))


def _basic_value(text: str, type_: BasicType) -> Scalar:
    match type_.typename:
        case "boolean":
            value = _BOOLEANS.get(text.lower())
            if value is None:
                raise BadValue("expected `true` or `false`")
            return value
        case "float" | "double":
            return _float(text)
        case "octet":
            return bytes([_integer(text, "octet")])
        case typename:
            return _integer(text, typename)


def _integer(text: str, typename: str) -> int:
    try:
        value = int(text)
    except ValueError:
        try:
            value = int(text, 0)
        except ValueError:
            raise BadValue("expected an integer such as `5`, `-5`, `0xFF`, `0b11` or `1_000`") from None
    low, high = INTEGER_RANGES[typename]
    if not low <= value <= high:
        raise BadValue(f"out of range: must be between {low} and {high}")
    return value


def _float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise BadValue("expected a number such as `1.5`, `-2` or `1e-3`") from None
    if not math.isfinite(value):
        raise BadValue("`nan` and `inf` cannot be written in an interface", rule="not-finite")
    return value


def _string_text(text: str, type_: StringType) -> str:
    for quote in ('"', "'"):
        if text.startswith(quote) and text.endswith(quote):
            text = text[1:-1]
            if text.replace("\\" + quote, "").find(quote) >= 0:
                raise BadValue(f"a {quote} inside the quotes must be written \\{quote}")
            text = text.replace("\\" + quote, quote)
            break
    if isinstance(type_, BoundedString | BoundedWString) and len(text) > type_.maximum_size:
        raise BadValue(f"longer than the bound of {type_.maximum_size} characters")
    return text


def _without_nul(text: str) -> str:
    if "\0" in text:
        raise BadValue("rosidl's C and C++ code ends a string at a NUL", rule="unportable-string")
    return text


def _array(text: str, type_: Array | BoundedSequence | UnboundedSequence) -> tuple[Scalar, ...]:
    element = type_.value_type
    if isinstance(element, NamespacedType):
        raise BadValue("a field of a message type cannot have a default value", rule="nested-default")
    if not (text.startswith("[") and text.endswith("]")):
        raise BadValue("the default of an array must be written as `[a, b, c]`")
    inside = text[1:-1]
    if isinstance(element, BasicType):
        texts = inside.split(",") if inside else []
    else:
        texts = _split_strings(inside)
    check_count(len(texts), type_)
    if isinstance(element, BasicType):
        return tuple([_element(item, element) for item in texts])
    arrived = carried_in_array([_string_text(item.strip(), element) for item in texts])
    return tuple([_without_nul(item) for item in arrived])


def _element(text: str, type_: BasicType) -> Scalar:
    text = text.strip()
    if not text:
        raise BadValue("an element is missing", "write `[1, 2, 3]`, or `[]` for an empty array")
    try:
        return _basic_value(text, type_)
    except BadValue as error:
        raise BadValue(f"`{shorten(text, 20)}`: {error.message}", error.help, error.rule) from None


def check_count(count: int, type_: Array | BoundedSequence | UnboundedSequence) -> None:
    """Raise BadValue if an array or a sequence of this type cannot have the given number of elements."""
    if isinstance(type_, Array) and count != type_.size:
        raise BadValue(f"expected exactly {type_.size} elements, found {count}")
    if isinstance(type_, BoundedSequence) and count > type_.maximum_size:
        raise BadValue(f"expected at most {type_.maximum_size} elements, found {count}")


def _split_strings(text: str) -> list[str]:
    """The elements of an array of strings, as rosidl_adapter walks them: quoted or up to the next comma."""
    elements: list[str] = []
    position, end = 0, len(text)
    while position < end:
        position = _behind_spaces(text, position)
        if position == end:
            raise BadValue("expected another element before the `]`", "remove the spaces before it")
        if text[position] == ",":
            raise BadValue("expected an element before the `,`")
        for quote in ('"', "'"):
            if text.startswith(quote, position):
                closing = _closing_quote(text, position, quote)
                elements.append(text[position + 1 : closing].replace("\\" + quote, quote))
                position = closing + 1
                break
        else:
            comma = text.find(",", position)
            comma = end if comma < 0 else comma
            elements.append(text[position:comma])
            position = comma
        position = _behind_spaces(text, position)
        if position < end and text[position] == ",":
            position += 1
    return elements


def _behind_spaces(text: str, position: int) -> int:
    match = _SPACES.match(text, position)
    return match.end() if match else position


_MAX_ESCAPED_QUOTES: Final = 100
"""In one element of an array: each one may make us read on to the end of the text, once for every element."""


def _closing_quote(text: str, opening: int, quote: str) -> int:
    """The end, for rosidl_adapter, of the quoted element that opens here.

    After an escaped quote it continues the search, but skips one character. When it counts back, it forgets
    all but the last such step: with two escaped quotes the end is too early.
    """
    before = start = opening
    for _ in range(_MAX_ESCAPED_QUOTES):
        found = text.find(quote, start + 1)
        if found < 0:
            raise BadValue(f"the {quote} that opens an element is not closed")
        if text[found - 1] != "\\":
            return opening + found - before
        before, start = start, found + 1
    raise BadValue(f"more than {_MAX_ESCAPED_QUOTES} escaped quotes in one element")
