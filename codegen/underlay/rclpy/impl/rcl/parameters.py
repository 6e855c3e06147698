"""Parameter overrides from the command line and from parameter files, as rcl_yaml_param_parser reads them.

Overrides are kept by node pattern (`/**`, `/ns/*`, `/n`). Patterns keep the order in which they first appear
over all sources; later sources overwrite values inside a pattern. A node takes every pattern that matches
it in that order, so a later pattern wins over an earlier one however specific they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

from ifgen_runtime.parameters.parameter_scalars import ParameterVariant, Value, read_scalar

from .names import rclpy_get_validation_error_for_namespace, rclpy_get_validation_error_for_node_name
from .rules import Lexeme, Lexer, RuleError

_WILDCARDS: Final = ("*", "**")

Entry = dict[str, ParameterVariant]


class ParameterOverrides:
    """Parameters by node pattern as it was written (`n` is not `/n`), in order of first appearance."""

    def __init__(self) -> None:
        self._entries: dict[str, Entry] = {}
        self._by_hand: set[tuple[str, str]] = set()  # pattern and name of each `-p`
        self._used: dict[str, set[str]] = {}  # the names that nodes have declared, by pattern
        self._nodes: set[str] = set()

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

    def override(self, pattern: str, name: str) -> ParameterVariant:
        """The parameter that `-p` names, created when missing. Raises RuleError for a bad pattern."""
        self._by_hand.add((pattern, name))
        return self.entry(pattern).setdefault(name, ParameterVariant())

    def use(self, full_name: str, names: Iterable[str] | None) -> None:
        """Note that a node is there, and has declared parameters; None stands for all of them."""
        self._nodes.add(full_name)
        for pattern, entry in self._entries.items():
            if _matches(pattern, full_name):
                self._used.setdefault(pattern, set()).update(entry if names is None else names)

    def unused(self) -> Iterator[str]:
        """A sentence for each override that no node took, if it was given for one node or with `-p`.

        A file for several nodes is as it should be if one of them is here.
        """
        from difflib import get_close_matches  # only the end of a program needs it

        exact = [pattern for pattern in self._entries if "*" not in pattern]
        if self._nodes and exact and not any(pattern in self._used for pattern in exact):
            nodes = ", ".join(sorted(self._nodes))
            yield f"Parameters for {', '.join(exact)} were given, but there was no such node: only {nodes}"
        for pattern, used in self._used.items():
            for name in self._entries[pattern]:
                is_meant = pattern in exact or (pattern, name) in self._by_hand
                if is_meant and name not in used:
                    near = get_close_matches(name, used, n=1, cutoff=0.5)
                    advice = f": did you mean '{near[0]}'?" if near else ""
                    yield f"The parameter '{name}' was given, but no node declared it{advice}"


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
    variant = overrides.override("/**" if node is None else node, name)
    # Most values are a plain word or number: they need no YAML parser, whose import costs milliseconds.
    if re.fullmatch(r"[\w.+/]+", text, re.ASCII):
        variant.set_scalar(read_scalar(text))
        return
    from ifgen_runtime.parameters import parameter_yaml  # with a YAML parser

    try:
        parameter_yaml.read_value(text, variant)
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


def read_file(path: str, overrides: ParameterOverrides) -> None:
    """Read a parameter file into `overrides`; raises RuleError."""
    from ifgen_runtime.parameters import parameter_yaml  # with a YAML parser

    try:
        parameter_yaml.read_file(path, overrides.entry)
    except parameter_yaml.ParameterYamlError as error:
        raise RuleError(str(error)) from None
