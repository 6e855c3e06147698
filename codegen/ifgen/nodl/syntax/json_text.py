"""From JSON to a tree with places: the standard library's parser keeps none."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Final, NoReturn

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source, Span, shorten
from ifgen.nodl.syntax import explain, texts
from ifgen.nodl.syntax.tree import MAX_DEPTH, MAX_VALUES, Key, ListNode, MapNode, Node, ScalarNode, size_of
from ifgen.nodl.syntax.yaml_text import UnreadableError

# The standard library's own function for strings in JSON, which its type stubs leave out.
_scan_string: Callable[[str, int], tuple[str, int]] = json.decoder.scanstring  # type: ignore[attr-defined]
_SPACE: Final = re.compile(r"[ \t\r\n]*")
_NUMBER: Final = re.compile(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][-+]?[0-9]+)?")
_WORDS: Final = {"true": True, "false": False, "null": None}


def parse(source: Source, problems: FileProblems) -> Node | None:
    """The value in a JSON text; None if it is empty, UnreadableError if it cannot be read on."""
    reader = _Reader(source, problems)
    reader.skip_space()
    if reader.at_end():
        return None
    node = reader.value(0)
    reader.skip_space()
    if not reader.at_end():
        reader.fail("there is more after the document")
    return node


class _Reader:
    """A place in a text, and what has been read up to there."""

    def __init__(self, source: Source, problems: FileProblems) -> None:
        self._source = source
        self._problems = problems
        self._text = source.text
        self._at = 1 if source.text.startswith("\ufeff") else 0
        self._values = 0

    def at_end(self) -> bool:
        return self._at >= len(self._text)

    def skip_space(self) -> None:
        match = _SPACE.match(self._text, self._at)
        self._at = match.end() if match else self._at

    def fail(self, message: str, at: int | None = None) -> NoReturn:
        place = min(self._at if at is None else at, len(self._text))
        raise UnreadableError(explain.syntax("JSON", message, Span(self._source, place, place + 1)))

    def value(self, depth: int) -> Node:
        """The value that starts here."""
        self._values += 1
        here = Span(self._source, self._at, self._at + 1)
        if self._values > MAX_VALUES:
            raise UnreadableError(explain.too_large(here))
        if depth > MAX_DEPTH:
            raise UnreadableError(explain.too_deep(here))
        match self._text[self._at : self._at + 1]:
            case "{":
                return self._map(depth)
            case "[":
                return self._list(depth)
            case '"':
                start = self._at
                text = self._string()
                return ScalarNode(text, Span(self._source, start, self._at), plain=False)
            case _:
                return self._word_or_number()

    def _map(self, depth: int) -> MapNode:
        start = self._at
        entries: dict[str, tuple[Key, Node]] = {}
        while self._has_next("{" if self._at == start else ",", "}", start):
            if self._text[self._at : self._at + 1] != '"':
                self.fail("a key in double quotes belongs here")
            key_start = self._at
            key = Key(self._string(), Span(self._source, key_start, self._at))
            self.skip_space()
            if self._text[self._at : self._at + 1] != ":":
                self.fail("a `:` belongs after a key")
            self._at += 1
            self.skip_space()
            value = self.value(depth + 1)
            if key.name in entries:
                self._problems.error(explain.duplicate_key, key, entries[key.name][0])
            else:
                entries[key.name] = (key, value)
        size = 1 + sum(size_of(value) for _, value in entries.values())
        return MapNode(tuple(entries.values()), Span(self._source, start, self._at), size)

    def _list(self, depth: int) -> ListNode:
        start = self._at
        items: list[Node] = []
        while self._has_next("[" if self._at == start else ",", "]", start):
            items.append(self.value(depth + 1))
        size = 1 + sum(map(size_of, items))
        return ListNode(tuple(items), Span(self._source, start, self._at), size)

    def _has_next(self, lead: str, closing: str, start: int) -> bool:
        """Step over what comes before the next item; False once the closing bracket has been passed."""
        self.skip_space()
        found = self._text[self._at : self._at + 1]
        if found == closing and lead == ",":
            self._at += 1
            return False
        if found != lead:
            opened = self._source.position(start)[0]
            self.fail(f"`,` or `{closing}` belongs here, for what was opened on line {opened}")
        self._at += 1
        self.skip_space()
        if lead != "," and self._text[self._at : self._at + 1] == closing:
            self._at += 1
            return False
        return True

    def _string(self) -> str:
        start = self._at
        try:
            text, self._at = _scan_string(self._text, start + 1)
        except json.JSONDecodeError as error:
            self.fail(error.msg[:1].lower() + error.msg[1:].removesuffix(" at"), error.pos)
        return texts.carried(text, Span(self._source, start, self._at), self._problems)

    def _word_or_number(self) -> ScalarNode:
        start = self._at
        for word, value in _WORDS.items():
            if self._text.startswith(word, start):
                self._at += len(word)
                return ScalarNode(value, Span(self._source, start, self._at))
        match = _NUMBER.match(self._text, start)
        if match is None:
            self.fail("a value belongs here: a text in double quotes, a number, a list, a map")
        self._at = match.end()
        span = Span(self._source, start, self._at)
        try:
            return ScalarNode(float(match[0]) if match[1] or match[2] else int(match[0]), span)
        except ValueError:
            self._problems.error(explain.bad_number, span, shorten(match[0]))
            return ScalarNode(0, span)
