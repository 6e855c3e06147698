"""Conditions of `if()`, with a doubt where only a build knows the answer."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

from ifgen.reading import storage
from ifgen.reading.cmake import patterns
from ifgen.reading.cmake.values import Doubt, Value, elements, worse
from ifgen.reading.cmake.variables import ENVIRONMENT
from ifgen.reading.cmake.words import Word

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
        *("MATCHES", "IN_LIST", "PATH_EQUAL", "IS_NEWER_THAN"),
    )
)


class Answer(NamedTuple):
    """Whether a condition holds, and what is not sure about that."""

    holds: bool
    doubt: Doubt | None = None


@dataclass(frozen=True, slots=True)
class Asked:
    """The queries of a condition: the value of a variable, whether a command is defined, and a doubt.

    `regex` is `patterns.regex` with its cost paid for; paths are relative to `folder`.
    """

    variable: Callable[[str], Value | None]
    has_command: Callable[[str], bool]
    doubt: Callable[[str], Doubt]
    regex: Callable[[str, Sequence[str]], re.Pattern[str]]
    folder: Path


def holds(words: Sequence[Word], asked: Asked) -> Answer:
    """Whether a condition holds. One that is wrong is in doubt."""
    evaluation = _Evaluation(words, asked)
    with suppress(_WrongError):
        answer = evaluation.compound(0)
        if evaluation.is_done():
            return answer
    return Answer(True, asked.doubt("this condition cannot be understood"))


class _WrongError(Exception):
    """The words are no condition."""


class _Evaluation:
    def __init__(self, words: Sequence[Word], asked: Asked) -> None:
        self._words = words
        self._asked = asked
        self._at = 0

    def is_done(self) -> bool:
        return self._at == len(self._words)

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
            if depth == _MAX_NESTING:
                raise _WrongError
            answer = self.compound(depth + 1)
            if not self._accept(")"):
                raise _WrongError
            return answer
        word = self._next()
        if not word.quoted and word.text in _UNARY and self._at < len(self._words):
            return self._unary(word.text, self._next())
        following = self._words[self._at] if self._at < len(self._words) else None
        if following is not None and not following.quoted and following.text in _BINARY:
            self._at += 1
            return self._binary(word, following.text, self._next())
        return self._truth(word)

    def _accept(self, text: str) -> bool:
        if self._at < len(self._words) and self._words[self._at][:2] == (text, False):
            self._at += 1
            return True
        return False

    def _next(self) -> Word:
        if self._at == len(self._words):
            raise _WrongError
        self._at += 1
        return self._words[self._at - 1]

    def _truth(self, word: Word) -> Answer:
        constant = _constant(word.text)
        if constant is not None:
            return Answer(constant, word.doubt)
        value = None if word.quoted else self._asked.variable(word.text)
        if value is None:
            return Answer(False, word.doubt)
        if value.doubt is not None and value.doubt.lost:
            return Answer(True, value.doubt)
        return Answer(_constant(value.text) is not False, worse(word.doubt, value.doubt))

    def _unary(self, test: str, word: Word) -> Answer:
        if test == "DEFINED":
            name = word.text
            if name.startswith("ENV{"):
                name = name[4:].removesuffix("}")
                is_known = name in ENVIRONMENT
                doubt = None if is_known else self._asked.doubt(f"it is not known whether {name} is set")
                return Answer(is_known, doubt)
            value = self._asked.variable(name)
            return Answer(value is not None, worse(word.doubt, value.doubt if value else None))
        if test == "COMMAND" and self._asked.has_command(word.text.lower()):
            return Answer(True)
        if test == "IS_ABSOLUTE":
            return Answer(word.text.startswith("/"), word.doubt)
        if test == "POLICY":
            return Answer(True)
        if test in {"EXISTS", "IS_DIRECTORY", "IS_SYMLINK"}:
            tests = {
                "EXISTS": storage.exists,
                "IS_DIRECTORY": storage.is_folder,
                "IS_SYMLINK": Path.is_symlink,
            }
            try:
                return Answer(bool(word.text) and tests[test](self._asked.folder / word.text), word.doubt)
            except (OSError, ValueError):
                return Answer(False, word.doubt)
        return Answer(
            True, self._asked.doubt(f"it is not known whether there is a {test.lower()} {word.text}")
        )

    def _binary(self, left: Word, test: str, right: Word) -> Answer:
        first = self._dereferenced(left)
        if test == "IN_LIST":
            items = self._asked.variable(right.text)
            doubt = worse(first.doubt, items.doubt if items else None)
            return Answer(first.text in elements(items.text if items else "", keep_empty=True), doubt)
        second = Value(right.text, right.doubt) if test == "MATCHES" else self._dereferenced(right)
        doubt = worse(first.doubt, second.doubt)
        if test == "MATCHES":
            try:
                pattern = self._asked.regex(second.text, [first.text])
            except patterns.Unsure:
                return Answer(True, self._asked.doubt("this regular expression cannot be evaluated"))
            return Answer(pattern.search(first.text) is not None, doubt)
        if test in {"PATH_EQUAL", "IS_NEWER_THAN"}:
            return Answer(first.text == second.text, doubt)
        if test.startswith("VERSION_"):
            order = _ORDERS[test.removeprefix("VERSION_")]
            return Answer(order(_version(first.text), _version(second.text)), doubt)
        if test.startswith("STR"):
            return Answer(_ORDERS[test.removeprefix("STR")](first.text, second.text), doubt)
        numbers = [_NUMBER.match(value.text) for value in (first, second)]
        if not all(numbers):
            return Answer(False, doubt)
        return Answer(_ORDERS[test](*(float(number[0]) for number in numbers if number)), doubt)

    def _dereferenced(self, word: Word) -> Value:
        """An operand that is no quoted text may name a variable."""
        value = None if word.quoted else self._asked.variable(word.text)
        if value is None:
            return Value(word.text, word.doubt)
        return Value(value.text, worse(word.doubt, value.doubt))


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
