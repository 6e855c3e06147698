"""Parameter overrides from the command line and from parameter files, as rcl_yaml_param_parser reads them.

Overrides are kept by node pattern (`/**`, `/ns/*`, `/n`). Patterns keep the order in which they first appear
over all sources; later sources overwrite values inside a pattern. A node takes every pattern that matches
it in that order, so a later pattern wins over an earlier one however specific they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from ifgen_runtime.parameter_scalars import ParameterVariant, Value, read_scalar

from .lexer import Lexeme, Lexer, RuleError
from .names import rclpy_get_validation_error_for_namespace, rclpy_get_validation_error_for_node_name

__all__ = ["ParameterOverrides", "parse_override_rule"]

_WILDCARDS: Final = ("*", "**")

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
    from ifgen_runtime import parameter_yaml  # with a YAML parser

    try:
        parameter_yaml.read_value(text, entry.setdefault(name, ParameterVariant()))
    except parameter_yaml.ParameterYamlError as error:
        raise RuleError(str(error)) from None


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
