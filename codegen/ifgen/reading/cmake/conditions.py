"""Conditions of `if()`, with a doubt where only a build knows the answer."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final, NamedTuple

from ifgen.reading import storage
from ifgen.reading.cmake.state import ENVIRONMENT, State
from ifgen.reading.cmake.values import Doubt, Unsure, Value, elements, worse

_TRUE: Final = frozenset({"1", "ON", "YES", "TRUE", "Y"})
_FALSE: Final = frozenset({"", "0", "OFF", "NO", "FALSE", "N", "IGNORE", "NOTFOUND"})
_NUMBER: Final = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_MAX_NESTING: Final = 20

_ORDERS: Final[Mapping[str, Callable[[Any, Any], bool]]] = {
    "EQUAL": operator.eq,
    "LESS": operator.lt,
    "GREATER": operator.gt,
    "LESS_EQUAL": operator.le,
    "GREATER_EQUAL": operator.ge,
}
_UNARY: Final = frozenset(
    ("EXISTS", "IS_DIRECTORY", "IS_SYMLINK", "IS_ABSOLUTE", "COMMAND", "POLICY", "TARGET", "TEST", "DEFINED")
)
_BINARY: Final = frozenset(
    (
        *(f"{kind}{order}" for kind in ("", "STR", "VERSION_") for order in _ORDERS),
        *("MATCHES", "IN_LIST"),
    )
)


class Answer(NamedTuple):
    """Whether a condition holds, and what is not sure about that."""

    holds: bool
    doubt: Doubt | None = None


def evaluate(words: Sequence[Value], state: State, defined: Collection[str]) -> Answer:
    """Whether a condition holds; `defined` are the commands that there are. One that is wrong is in doubt."""
    condition = _Condition(words, state, defined)
    with suppress(_WrongError):
        answer = condition.compound(0)
        if condition.at == len(words):
            return answer
    return Answer(True, state.doubt("this condition cannot be understood"))


class _WrongError(Exception):
    """The words are no condition."""


class _Condition:
    def __init__(self, words: Sequence[Value], state: State, defined: Collection[str]) -> None:
        self._words = words
        self._state = state
        self._variable = state.variables.get
        self._defined = defined
        self.at = 0

    def compound(self, depth: int) -> Answer:
        """`AND` and `OR` bind alike: from left to right, whatever stands where."""
        answer = self._negated(depth)
        while True:
            if self._accept("OR"):
                answer = _either(answer, self._negated(depth))
            elif self._accept("AND"):
                answer = _not(_either(_not(answer), _not(self._negated(depth))))
            else:
                return answer

    def _negated(self, depth: int) -> Answer:
        odd = False
        while self._accept("NOT"):
            odd = not odd
        answer = self._test(depth)
        return _not(answer) if odd else answer

    def _test(self, depth: int) -> Answer:
        if self._accept("("):
            answer = self.compound(depth + 1) if depth < _MAX_NESTING else None
            if answer is None or not self._accept(")"):
                raise _WrongError
            return answer
        word = self._next()
        following = self._words[self.at] if self.at < len(self._words) else None
        if following is None:
            return self._truth(word)
        if not word.quoted and word.text in _UNARY:
            return self._unary(word.text, self._next())
        if not following.quoted and following.text in _BINARY:
            self.at += 1
            return self._binary(word, following.text, self._next())
        return self._truth(word)

    def _accept(self, text: str) -> bool:
        if self.at == len(self._words):
            return False
        word = self._words[self.at]
        accepted = word.text == text and not word.quoted
        self.at += accepted
        return accepted

    def _next(self) -> Value:
        if self.at == len(self._words):
            raise _WrongError
        self.at += 1
        return self._words[self.at - 1]

    def _truth(self, word: Value) -> Answer:
        constant = _constant(word.text)
        if constant is not None:
            return Answer(constant, word.doubt)
        value = None if word.quoted else self._variable(word.text)
        if value is None:
            return Answer(False, word.doubt)
        if value.doubt is not None and value.doubt.lost:
            return Answer(True, value.doubt)
        return Answer(_constant(value.text) is not False, worse(word.doubt, value.doubt))

    def _unary(self, test: str, word: Value) -> Answer:
        text = word.text
        if test == "DEFINED" and text.startswith("ENV{"):
            name = text[4:].removesuffix("}")
            doubt = self._state.doubt(f"it is not known whether {name} is set")
            return Answer(True) if name in ENVIRONMENT else Answer(False, doubt)
        if test == "DEFINED":
            value = self._variable(text)
            return Answer(value is not None, worse(word.doubt, value.doubt if value else None))
        if test == "POLICY" or (test == "COMMAND" and text.lower() in self._defined):
            return Answer(True)
        if test in {"EXISTS", "IS_DIRECTORY"}:
            there = storage.exists if test == "EXISTS" else storage.is_folder
            try:
                return Answer(bool(text) and there(self._state.folder / text), word.doubt)
            except (OSError, ValueError):
                return Answer(False, word.doubt)
        return Answer(True, self._state.doubt(f"it is not known whether there is a {test.lower()} {text}"))

    def _binary(self, left: Value, test: str, right: Value) -> Answer:
        first = self._dereferenced(left)
        if test == "IN_LIST":
            items = self._state.variables.value(right.text)
            return Answer(
                first.text in elements(items.text, keep_empty=True), worse(first.doubt, items.doubt)
            )
        second = right if test == "MATCHES" else self._dereferenced(right)
        doubt = worse(first.doubt, second.doubt)
        if test == "MATCHES":
            try:
                pattern = self._state.regex(second.text, [first.text])
            except Unsure:
                return Answer(True, self._state.doubt("this regular expression cannot be evaluated"))
            return Answer(pattern.search(first.text) is not None, doubt)
        if test.startswith("VERSION_"):
            order = _ORDERS[test.removeprefix("VERSION_")]
            return Answer(order(_version(first.text), _version(second.text)), doubt)
        if test.startswith("STR"):
            return Answer(_ORDERS[test.removeprefix("STR")](first.text, second.text), doubt)
        numbers = [_NUMBER.match(value.text) for value in (first, second)]
        if not all(numbers):
            return Answer(False, doubt)
        return Answer(_ORDERS[test](*(float(number[0]) for number in numbers if number)), doubt)

    def _dereferenced(self, word: Value) -> Value:
        """An operand that is no quoted text may name a variable."""
        value = None if word.quoted else self._variable(word.text)
        return word if value is None else Value(value.text, worse(word.doubt, value.doubt))


def _constant(text: str) -> bool | None:
    """The truth value of a constant; None if it is the name of a variable."""
    upper = text.upper()
    if upper in _TRUE:
        return True
    if upper in _FALSE or upper.endswith("-NOTFOUND"):
        return False
    number = _NUMBER.fullmatch(text)
    return float(number[0]) != 0 if number else None


def _version(text: str) -> list[int]:
    """The numbers of a version, up to what is none; those that are missing count as 0."""
    match = re.match(r"\d{1,9}(?:\.\d{1,9})*", text)
    numbers = [int(number) for number in match[0].split(".")] if match else []
    while numbers and not numbers[-1]:
        numbers.pop()
    return numbers


def _not(answer: Answer) -> Answer:
    return Answer(not answer.holds, answer.doubt)


def _either(first: Answer, second: Answer) -> Answer:
    for answer in (first, second):
        if answer.holds and answer.doubt is None:
            return answer
    return Answer(first.holds or second.holds, worse(first.doubt, second.doubt))
