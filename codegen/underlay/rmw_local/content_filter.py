"""Content filters: expressions in the SQL subset of DDS, as Fast DDS reads them, made into predicates.

The type of the messages is known, so everything that is wrong is refused when the filter is set. `fields_of`
names the fields; integers compare with floats, texts with texts only.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, Final, NoReturn

from ifgen_runtime.field_types import Basic, Field, Text, fields_of

from rmw_local.message import DecodeError

if TYPE_CHECKING:
    from rmw_local.reader import Sample
    from rmw_local.writer import RemoteSink, Writer

MOST_PARAMETERS: Final = 100

_Message = Any
_Predicate = Callable[[_Message], bool]
_TOKENS: Final = re.compile(
    r"\s*(?:(?P<text>'[^']*')|(?P<number>[-+]?(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?))"
    r"|(?P<parameter>%\d+)|(?P<name>[A-Za-z_]\w*(?:\[\d+\])?(?:\.[A-Za-z_]\w*(?:\[\d+\])?)*)"
    r"|(?P<sign><>|!=|<=|>=|[=<>()]))"
)
_COMPARISONS: Final[dict[str, Callable[[Any, Any], bool]]] = {
    "=": operator.eq,
    "<>": operator.ne,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
_MIRRORED: Final = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_PATTERN: Final = re.compile(r"\b(LIKE|MATCH)\b", re.IGNORECASE)
_KEYWORDS: Final = ("AND", "OR", "NOT", "BETWEEN", "LIKE", "MATCH")


class FilterError(ValueError):
    """An expression or its parameters cannot be used; the text says what is wrong and where."""


class _Absent(LookupError):
    """A sequence of the message is too short for the index in the expression."""


@dataclass(frozen=True, slots=True)
class _Operand:
    """One side of a comparison: a field, or a literal with its `value`. `kind` is bool, float or str."""

    kind: type
    value: Any = None
    get: Callable[[_Message], Any] | None = None


@dataclass(frozen=True)
class ContentFilter:
    """An expression with its parameters for one class of messages, and the `predicate` made of them."""

    expression: str
    parameters: tuple[str, ...]
    predicate: _Predicate

    def accepts(self, message: _Message) -> bool:
        """Return whether the expression is true for a message."""
        try:
            return self.predicate(message)
        except _Absent:
            return False


def compile_filter(cls: type[Any], expression: str, parameters: Sequence[str]) -> ContentFilter | None:
    """Return the filter of an expression for a message class; None for an empty one. Raises FilterError."""
    if len(parameters) > MOST_PARAMETERS:
        raise FilterError(
            f"The maximum of expression parameters argument number is {MOST_PARAMETERS}, "
            f"but {len(parameters)} were given"
        )
    if not expression.strip():
        return None
    return ContentFilter(expression, tuple(parameters), _Parser(cls, expression, parameters).whole())


class Sieve:
    """A way to other processes for those messages only that a reader there accepts.

    What cannot be read is sent, so that readers say what is wrong with it.
    """

    def __init__(self, writer: Writer, sink: RemoteSink, filters: Sequence[ContentFilter]) -> None:
        self.last = writer.last_elsewhere
        """The number of the last message that was sent."""
        self.assert_alive = sink.assert_alive
        self.wait_until_received = sink.wait_until_received
        self.announce = sink.announce
        self._accept = sink.accept
        self._filters = filters
        self._deserialize = writer.message_type.deserialize

    def accept(self, sample: Sample) -> None:
        """Send a message if one of the readers wants it."""
        try:
            message = self._deserialize(sample[0])
            is_wanted = any(each.accepts(message) for each in self._filters)
        except DecodeError:
            is_wanted = True
        if is_wanted:
            self.last = sample[2]
            self._accept(sample)

    store = accept


def sieve_of(writer: Writer, sink: RemoteSink, wanted: Sequence[tuple[str, tuple[str, ...]]]) -> Sieve | None:
    """Return the sieve of expressions with their parameters; None if one of them cannot be used here.

    They come from other processes. Patterns are left to these, because one can be slow without end.
    """
    if any(_PATTERN.search(expression) for expression, _ in wanted):
        return None
    try:
        filters = [compile_filter(writer.message_type.cls, *each) for each in wanted]
    except (FilterError, RecursionError):
        return None
    known = [each for each in filters if each is not None]
    return Sieve(writer, sink, known) if len(known) == len(filters) else None


class _Parser:
    """A parser by recursive descent, for one expression."""

    def __init__(self, cls: type[Any], expression: str, parameters: Sequence[str]) -> None:
        self._cls = cls
        self._expression = expression
        self._parameters = parameters
        self._tokens = list(self._scan(expression))
        self._index = 0

    def whole(self) -> _Predicate:
        """The predicate of the whole expression."""
        predicate = self._disjunction()
        if self._kind != "end":
            self._refuse("AND, OR or the end")
        return predicate

    def _scan(self, text: str) -> list[tuple[str, str]]:
        tokens, at = [], 0
        while text[at:].strip():
            match = _TOKENS.match(text, at)
            if match is None:
                raise FilterError(
                    f"{text[at:].strip()!r} in {self._expression!r} is no part of an expression"
                )
            kind = str(match.lastgroup)
            word = match[kind]
            if kind == "name" and word.upper() in _KEYWORDS:
                kind, word = "keyword", word.upper()
            tokens.append((kind, word))
            at = match.end()
        return [*tokens, ("end", "")]

    @property
    def _kind(self) -> str:
        return self._tokens[self._index][0]

    @property
    def _word(self) -> str:
        return self._tokens[self._index][1]

    def _accept(self, *words: str) -> str:
        """Skip a sign or a keyword, if it is one of these, and return it."""
        word = self._word
        if self._kind in ("sign", "keyword") and word in words:
            self._index += 1
            return word
        return ""

    def _refuse(self, expected: str) -> NoReturn:
        found = f"'{self._word}'" if self._word else "the end"
        raise FilterError(f"{self._expression!r}: expected {expected}, found {found}")

    def _disjunction(self) -> _Predicate:
        parts = [self._conjunction()]
        while self._accept("OR"):
            parts.append(self._conjunction())
        return parts[0] if len(parts) == 1 else lambda message: any(part(message) for part in parts)

    def _conjunction(self) -> _Predicate:
        parts = [self._negation()]
        while self._accept("AND"):
            parts.append(self._negation())
        return parts[0] if len(parts) == 1 else lambda message: all(part(message) for part in parts)

    def _negation(self) -> _Predicate:
        if self._accept("NOT"):
            denied = self._negation()
            return lambda message: not denied(message)
        if self._accept("("):
            inner = self._disjunction()
            if not self._accept(")"):
                self._refuse("')'")
            return inner
        return self._comparison()

    def _comparison(self) -> _Predicate:
        left = self._operand()
        if left.get is not None and self._word in ("NOT", "BETWEEN"):
            is_denied = bool(self._accept("NOT"))
            if not self._accept("BETWEEN"):
                self._refuse("BETWEEN")
            return self._range(left, left.get, is_denied=is_denied)
        if pattern := self._accept("LIKE", "MATCH"):
            return self._pattern(left, pattern)
        sign = self._accept(*_COMPARISONS)
        if not sign:
            self._refuse("a comparison")
        right = self._operand()
        if left.get is None:
            left, right, sign = right, left, _MIRRORED.get(sign, sign)
        if left.get is None:
            raise FilterError(f"{self._expression!r}: a comparison needs a field")
        self._must_agree(left, right)
        compare, get, other, value = _COMPARISONS[sign], left.get, right.get, right.value
        if other is None:
            return lambda message: compare(get(message), value)
        return lambda message: compare(get(message), other(message))

    def _range(self, field: _Operand, get: Callable[[_Message], Any], *, is_denied: bool) -> _Predicate:
        low = self._operand()
        if not self._accept("AND"):
            self._refuse("AND")
        high = self._operand()
        for limit in (low, high):
            if limit.get is not None:
                raise FilterError(f"{self._expression!r}: BETWEEN takes literals or parameters")
            self._must_agree(field, limit)
        return lambda message: (low.value <= get(message) <= high.value) is not is_denied

    def _pattern(self, field: _Operand, word: str) -> _Predicate:
        literal = self._operand()
        if field.get is None or field.kind is not str or literal.get is not None or literal.kind is not str:
            raise FilterError(f"{self._expression!r}: {word} takes a text field and a text")
        text = literal.value.decode()
        if word == "LIKE":
            parts = {"%": ".*", "*": ".*", "_": ".", "?": "."}
            text = "".join(parts.get(character, re.escape(character)) for character in text)
        try:
            matches = re.compile(text, re.DOTALL).fullmatch
        except re.error as error:
            raise FilterError(f"{self._expression!r}: {text!r} is no regular expression: {error}") from None
        get = field.get
        return lambda message: matches(get(message).decode()) is not None

    def _must_agree(self, left: _Operand, right: _Operand) -> None:
        kinds = {left.kind, right.kind}
        is_flag = kinds == {bool, float} and right.get is None and right.value in (0, 1)
        if len(kinds) > 1 and not is_flag:
            names = {bool: "a truth value", float: "a number", str: "a text"}
            raise FilterError(
                f"{self._expression!r}: {names[left.kind]} does not compare with {names[right.kind]}"
            )

    def _operand(self) -> _Operand:
        kind, word = self._kind, self._word
        self._index += 1
        if kind == "parameter":
            index = int(word[1:])
            if index >= len(self._parameters):
                raise FilterError(f"{self._expression!r}: there is no parameter for {word}")
            literal = self._parameters[index].strip()
            operand = _literal(literal)
            if operand is None:
                where = f"{self._expression!r}: the parameter {literal!r} of {word}"
                raise FilterError(f"{where} is no literal; texts need quotes")
            return operand
        if (operand := _literal(word)) is not None:
            return operand
        if kind != "name":
            self._index -= 1
            self._refuse("a field or a literal")
        return self._field(word)

    def _field(self, path: str) -> _Operand:
        cls: Any = self._cls
        steps: list[Callable[[Any], Any]] = []
        field: Field | None = None
        for part in path.split("."):
            name, _, index = part.rstrip("]").partition("[")
            fields = {each.name: each for each in fields_of(cls)} if isinstance(cls, type) else {}
            field = fields.get(name)
            if field is None:
                raise FilterError(f"{self._expression!r}: there is no field '{path}'")
            steps.append(operator.attrgetter(field.attribute))
            if bool(index) is not field.is_collection:
                needs = "needs an index" if field.is_collection else "has no elements"
                raise FilterError(f"{self._expression!r}: '{name}' of '{path}' {needs}")
            if index:
                steps.append(self._element(field, int(index)))
            cls = field.type
        assert field is not None, "a path has parts"
        kind = _kind_of(field)
        if kind is None:
            raise FilterError(f"{self._expression!r}: '{path}' is a message, not a value")
        if kind is str:
            steps.append(str.encode)  # Fast DDS orders bytes
        elif isinstance(field.type, Basic) and field.type.name == "octet":
            steps.append(ord)
        if len(steps) == 1:
            return _Operand(kind, get=steps[0])
        return _Operand(kind, get=lambda message: reduce(lambda value, step: step(value), steps, message))

    def _element(self, field: Field, index: int) -> Callable[[Any], Any]:
        if field.size is not None and index >= field.size:
            raise FilterError(f"{self._expression!r}: '{field.name}' has {field.size} elements, no [{index}]")

        def element(values: Any) -> Any:
            if index >= len(values):
                raise _Absent
            return values[index]

        return element


def _kind_of(field: Field) -> type | None:
    if isinstance(field.type, Text):
        return str
    if not isinstance(field.type, Basic):
        return None
    return bool if field.type.name == "boolean" else float


def _literal(word: str) -> _Operand | None:
    """A literal: a text in single quotes, a number, or TRUE or FALSE; None if it is none."""
    if len(word) > 1 and word[0] == word[-1] == "'":
        return _Operand(str, word[1:-1].encode())
    if word in ("TRUE", "true", "FALSE", "false"):
        return _Operand(bool, word.lower() == "true")
    try:
        return _Operand(float, int(word, 16) if "x" in word.lower() else int(word))
    except ValueError:
        pass
    try:
        return _Operand(float, float(word)) if word[:1] in "+-.0123456789" and word else None
    except ValueError:
        return None
