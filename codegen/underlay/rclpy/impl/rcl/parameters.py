"""Parameter overrides from the command line and from parameter files, as rcl_yaml_param_parser reads them.

Overrides are kept by node pattern (`/**`, `/ns/*`, `/n`). Patterns keep the order in which they first appear
over all sources; later sources overwrite values inside a pattern. A node takes every pattern that matches
it in that order, so a later pattern wins over an earlier one however specific they are.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from typing import Any, Final

from .lexer import Lexeme, Lexer, RuleError
from .names import rclpy_get_validation_error_for_namespace, rclpy_get_validation_error_for_node_name

__all__ = ["ParameterOverrides", "ParameterVariant", "parse_override_rule", "read_scalar"]

Scalar = bool | int | float | str
Value = Scalar | list[Any] | None

_TRUE = frozenset(["y", "Y", "yes", "Yes", "YES", "on", "On", "ON", "true", "True", "TRUE"])
_FALSE = frozenset(["n", "N", "no", "No", "NO", "off", "Off", "OFF", "false", "False", "FALSE"])
_INTEGER = re.compile(r"[+-]?(?:0[xX](?P<hex>[0-9a-fA-F]+)|0(?P<octal>[0-7]+)|[1-9][0-9]*|0)")
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_HEX_FLOAT = re.compile(r"[+-]?0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)(?:[pP][+-]?[0-9]+)?")
_C_NOT_FINITE = re.compile(r"[+-]?(?:inf|infinity|nan|nan\(\w*\))", re.IGNORECASE)
_YAML_NOT_FINITE = re.compile(r"[+-]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_WILDCARDS: Final = ("*", "**")
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
    return number if in_range or is_zero else text


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


Entry = dict[str, ParameterVariant]


class ParameterOverrides:
    """Parameters by node pattern as it was written (`n` is not `/n`), in order of first appearance."""

    def __init__(self) -> None:
        self._entries: dict[str, Entry] = {}

    def __bool__(self) -> bool:
        return bool(self._entries)

    def entry(self, pattern: str) -> Entry:
        """The parameters of a node pattern, created when missing. Raises RuleError for a bad pattern."""
        if pattern not in self._entries:
            _check_pattern(pattern)
        return self._entries.setdefault(pattern, {})

    def matching(self, full_name: str) -> Iterator[tuple[str, Value]]:
        """(name, value) of every override for the node `full_name`; later ones win."""
        for pattern, entry in self._entries.items():
            if _matches(pattern, full_name):
                for name, variant in entry.items():
                    yield name, variant.value()


def _check_pattern(pattern: str) -> None:
    """Raise RuleError unless the pattern is a node's full name, in which wildcards may stand for tokens."""
    namespace, _, name = _absolute(pattern).rpartition("/")
    if "//" in f"{namespace}/":
        raise RuleError(f"{namespace}/ contains repeated forward slash")
    for token in namespace.split("/")[1:]:
        if token not in _WILDCARDS and (error := rclpy_get_validation_error_for_namespace(f"/{token}")):
            raise RuleError(error[0])
    if name not in _WILDCARDS and (error := rclpy_get_validation_error_for_node_name(name)):
        raise RuleError(error[0])


def _absolute(pattern: str) -> str:
    return pattern if pattern.startswith("/") else f"/{pattern}"


def _matches(pattern: str, full_name: str) -> bool:
    """Whether `*` as one token and `**` as any number of tokens make the pattern the name."""
    pattern = _absolute(pattern)
    if "*" not in pattern:
        return pattern == full_name
    # A run of `**` is one `**`: without this, nested quantifiers would explode.
    expression = re.escape(re.sub(r"(?:/\*\*)+", "/**", pattern))
    expression = expression.replace(r"/\*\*", r"(?:/\w+)*").replace(r"/\*", r"/\w+")
    return re.fullmatch(expression, full_name) is not None


def parse_override_rule(rule: str, overrides: ParameterOverrides) -> None:
    """Read `[node:]name:=yaml` of `-p` into `overrides`; raises RuleError."""
    lexer = Lexer(rule)
    node = lexer.node_prefix()
    name = _parameter_name(lexer)
    text = lexer.rest()
    if not text:
        raise RuleError("error not set")  # the C layer says no more than this
    entry = overrides.entry("/**" if node is None else node)
    # Most values are a plain word or number: they need no YAML parser, whose import costs milliseconds.
    if re.fullmatch(r"[\w.+/]+", text, re.ASCII):
        entry.setdefault(name, ParameterVariant()).set_scalar(read_scalar(text))
        return
    from .parameter_files import read_value  # with a YAML parser

    read_value(text, entry.setdefault(name, ParameterVariant()))


def _parameter_name(lexer: Lexer) -> str:
    start = lexer.position
    while True:
        lexer.refuse_wildcards()
        while lexer.peek() in (Lexeme.TOKEN, Lexeme.SLASH):
            lexer.accept()
        if lexer.peek() is Lexeme.SEPARATOR:
            break
        lexer.expect(Lexeme.DOT)
    name = lexer.text[start : lexer.position]
    lexer.accept()
    return name
