"""Values of parameters as rcl_yaml_param_parser reads them, without a YAML parser, which loads slowly."""

from __future__ import annotations

import re
import sys
from typing import Any, Final

Scalar = bool | int | float | str
Value = Scalar | list[Any] | None

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


class ParameterVariant:
    """The value of one parameter; one slot a type, as in the C structure.

    A second value of another type does not evict the first: the reader takes the first filled slot.
    """

    __slots__ = ("_arrays", "_scalars")

    _ORDER: Final = (bool, int, float, str)

    def __init__(self) -> None:
        self._scalars: dict[type, Scalar] = {}
        self._arrays: dict[type, list[Any]] = {}

    def set_scalar(self, value: Scalar) -> None:
        """Fill the slot of the value's type."""
        self._scalars[type(value)] = value

    def start_array(self, value: Scalar) -> None:
        """Begin the array of the value's type with this element."""
        self._arrays[type(value)] = [value]

    def append(self, value: Scalar) -> None:
        """Add an element to the array of the value's type."""
        self._arrays.setdefault(type(value), []).append(value)

    def value(self) -> Value:
        """The overrides that a node sees, in a separate list; None if nothing was ever set."""
        for kind in self._ORDER:
            if kind in self._scalars:
                return self._scalars[kind]
        for kind in self._ORDER:
            if kind in self._arrays:
                return list(self._arrays[kind])
        return None
