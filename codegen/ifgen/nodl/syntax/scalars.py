"""Scalars of YAML: those of parameters as nodes read them, and texts as all readers of YAML understand them.

To nodes, `1e5` is a number and `y` is true, as rcl has it. ifgen must run without ifgen_runtime, whose
parameter_scalars reads the same values. A test compares the two.
"""

from __future__ import annotations

import re
import sys
from typing import Final

Scalar = bool | int | float | str

_TRUE = frozenset(["y", "Y", "yes", "Yes", "YES", "on", "On", "ON", "true", "True", "TRUE"])
_FALSE = frozenset(["n", "N", "no", "No", "NO", "off", "Off", "OFF", "false", "False", "FALSE"])
_INTEGER = re.compile(r"[+-]?(?:0[xX](?P<hex>[0-9a-fA-F]+)|0(?P<octal>[0-7]+)|[1-9][0-9]*|0)")
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_HEX_FLOAT = re.compile(r"[+-]?0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)(?:[pP][+-]?[0-9]+)?")
_C_NOT_FINITE = re.compile(r"[+-]?(?:inf|infinity|nan|nan\(\w*\))", re.IGNORECASE)
_YAML_NOT_FINITE = re.compile(r"[+-]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_INT64: Final = range(-(2**63), 2**63)


def read_scalar(text: str) -> Scalar:
    """The value of an unquoted YAML scalar: bool, int, float, else str. C's number syntax, not Python's."""
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    if found := _INTEGER.fullmatch(text):
        number = _read_integer(text, found)
        if number is not None and number in _INT64:
            return number
    return _read_float(text)


def _read_integer(text: str, found: re.Match[str]) -> int | None:
    if found["hex"]:
        return int(text, 16)
    if found["octal"]:
        return -int(found["octal"], 8) if text[0] == "-" else int(found["octal"], 8)
    return int(text) if len(text) <= 20 else None  # longer ones do not fit, and Python may refuse them


def _read_float(text: str) -> float | str:
    if _YAML_NOT_FINITE.fullmatch(text) or _C_NOT_FINITE.fullmatch(text):
        return float(text.replace(".", "").partition("(")[0])
    if _DECIMAL.fullmatch(text):
        number = float(text)
    elif _HEX_FLOAT.fullmatch(text):
        try:
            number = float.fromhex(text)
        except OverflowError:
            return text
    else:
        return text
    # Out of a normal double's range C reports an error, and the text stays text.
    is_zero = not re.search("[1-9a-fA-F]", re.split("[eEpP]", text.lower().removeprefix("0x"))[0])
    in_range = sys.float_info.min <= abs(number) <= sys.float_info.max
    return number if in_range or is_zero or _is_exact(text, number) else text


def _is_exact(text: str, number: float) -> bool:
    """Whether a hexadecimal text is exactly this subnormal number, of which C does not complain."""
    if number == 0 or "x" not in text.lower():
        return False
    digits, _, power = text.lower().lstrip("+-").removeprefix("0x").partition("p")
    if len(power) > 20:
        return False  # Python may refuse to read it
    whole, _, fraction = digits.partition(".")
    mantissa = int(whole + fraction, 16)
    numerator, denominator = abs(number).as_integer_ratio()
    shift = int(power or 0) - 4 * len(fraction) + denominator.bit_length() - 1
    if shift >= 0:
        return shift < 64 and mantissa << shift == numerator
    return mantissa == numerator << -shift if -shift < mantissa.bit_length() else False


# Characters that YAML reads unchanged, neither folded nor stripped, both in PyYAML and in the libyaml of ROS.
_PLAIN: Final = "\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff"
_ESCAPED: Final = re.compile(f'[^{_PLAIN}]|["\\\\]')
_LEFT_OUT: Final = re.compile(f"[^{_PLAIN}]")
_SHORT: Final = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "\b": "\\b", "\f": "\\f"}


def needs_escapes(text: str) -> bool:
    """Whether YAML can hold the text in double quotes only."""
    return _LEFT_OUT.search(text) is not None


def quoted(text: str) -> str:
    """The text in double quotes, with escapes that JSON has too where it has them."""
    return f'"{_ESCAPED.sub(_escape, text)}"'


def comment(text: str) -> list[str]:
    """The lines of a comment with this text, without `#` and without what YAML has no place for."""
    return [_LEFT_OUT.sub("", line.expandtabs(4)) for line in text.splitlines()]


def _escape(match: re.Match[str]) -> str:
    return _SHORT.get(match[0]) or f"\\u{ord(match[0]):04x}"
