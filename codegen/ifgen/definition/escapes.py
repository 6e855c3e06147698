r"""The backslashes and foreign characters of a string on rosidl's way from text to classes.

rosidl_adapter interprets the escapes when it writes a string into an .idl file, and rosidl_parser interprets
them again when it reads it: `"a\\\\b"` becomes `a\b`. The file is written as Latin-1 and read as UTF-8. An
array travels as the text of a Python tuple inside such a string, and Python interprets the escapes in it.
"""

from __future__ import annotations

import ast
import re
import warnings
from typing import Final

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
