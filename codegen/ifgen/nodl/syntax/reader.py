"""From the text of a document to its tree with places, by the events of PyYAML.

YAML 1.1 is read as PyYAML's safe_load reads it, which `ros2 nodl` uses. JSON is almost YAML, but stricter:
the standard library checks it, and its events come from its words.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from typing import Final, TypeVar

import yaml

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten
from ifgen.nodl.syntax import explain_syntax
from ifgen.nodl.syntax.tree import (
    MAX_DEPTH,
    MAX_VALUES,
    Foreign,
    Key,
    ListNode,
    MapNode,
    Node,
    ScalarNode,
    size_of,
)

_RESOLVER: Final = yaml.resolver.Resolver()
_CONSTRUCTOR: Final = yaml.constructor.SafeConstructor()
_TAG: Final = "tag:yaml.org,2002:"
_WRITTEN_TAG: Final = re.compile(r"!\S*")
_LEADING_ZERO: Final = re.compile(r"[-+]?0[0-9_]+")
_SURROGATE: Final = re.compile("[\ud800-\udfff]")
_JSON_TOKEN: Final = re.compile(r'"(?:[^"\\]|\\.)*"?|[\[\]{}]|[^\s\[\]{},:"]+', re.DOTALL)
_JSON_ERRORS: Final = {
    "Expecting value": "a value belongs here: a text in double quotes, a number, a list, a map",
    "Expecting property name": "a key in double quotes belongs here",
    "Expecting ':'": "a `:` belongs after a key",
    "Extra data": "there is more after the document",
}


class UnreadableError(Exception):
    """The text is no document at all; `diagnostic` says why."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


def parse(source: Source, problems: FileProblems) -> Node | None:
    """The one document in a text, which is JSON in files of that extension; None if it is empty.

    Raises UnreadableError if it cannot be read on.
    """
    try:
        if source.path.suffix == ".json":
            return _JsonComposer(source, problems).compose()
        return _Composer(source, problems).compose()
    except yaml.YAMLError as error:
        raise UnreadableError(_syntax(error, source)) from None


@dataclass(slots=True)
class _Open:
    """A list or map that is being read; the values of a map are in turns key and value."""

    start: yaml.Event
    values: list[Node] = field(default_factory=list[Node])


class _Composer:
    """Builds the tree from PyYAML's events, without its recursion and with limits."""

    def __init__(self, source: Source, problems: FileProblems) -> None:
        self._source = source
        self._problems = problems
        self._anchors: dict[str, Node | None] = {}
        self._open: list[_Open] = []
        self._values = 0
        self._root: Node | None = None

    def compose(self) -> Node | None:
        documents = 0
        for event in self._events():
            match event:
                case yaml.DocumentStartEvent():
                    documents += 1
                    if documents > 1:
                        raise UnreadableError(explain_syntax.second_document(self._span(event)))
                case yaml.AliasEvent():
                    self._add(self._aliased(event), event)
                case yaml.ScalarEvent():
                    self._tagged(event)
                    self._add(self._named(event, self._scalar(event)), event)
                case yaml.CollectionStartEvent():
                    self._tagged(event)
                    self._named(event, None)
                    self._open.append(_Open(event))
                    if len(self._open) > MAX_DEPTH:
                        raise UnreadableError(explain_syntax.too_deep(self._span(event)))
                case yaml.CollectionEndEvent():
                    opened = self._open.pop()
                    self._add(self._named(opened.start, self._closed(opened, event)), event)
                case _:
                    pass
        return self._root

    def _events(self) -> Iterator[yaml.Event]:
        loader = yaml.SafeLoader(self._source.text)
        try:
            while loader.check_event():
                yield loader.get_event()  # type: ignore[no-untyped-call]
        except (ValueError, OverflowError):
            # PyYAML leaves numbers to Python that it cannot have: of a character, or in `%YAML 1.999...`.
            place: int = loader.get_mark().index
            span = Span(self._source, place, place + 1)
            if self._source.text[place - 2 : place] == "\\U":
                raise UnreadableError(
                    explain_syntax.code_point(Span(self._source, place - 2, place + 8))
                ) from None
            raise UnreadableError(explain_syntax.syntax("YAML", "the number is too large", span)) from None

    def _add(self, node: Node, event: yaml.Event) -> None:
        self._values += size_of(node) if isinstance(event, yaml.AliasEvent) else 1
        if self._values > MAX_VALUES:
            raise UnreadableError(explain_syntax.too_large(self._span(event)))
        if self._open:
            self._open[-1].values.append(node)
        else:
            self._root = node

    _N = TypeVar("_N", bound=Node | None)

    def _named(self, event: yaml.Event, node: _N) -> _N:
        """The node, which aliases find if it has an anchor; None stands for one that is not complete."""
        anchor: str | None = getattr(event, "anchor", None)
        if anchor is not None:
            self._anchors[anchor] = node
        return node

    def _aliased(self, event: yaml.AliasEvent) -> Node:
        name = str(event.anchor)
        if name not in self._anchors:
            raise UnreadableError(explain_syntax.unknown_anchor(name, list(self._anchors), self._span(event)))
        node = self._anchors[name]
        if node is None:
            raise UnreadableError(explain_syntax.alias_in_itself(name, self._span(event)))
        return node

    def _tagged(self, event: yaml.ScalarEvent | yaml.CollectionStartEvent) -> None:
        if event.tag is not None and event.tag != "!":
            span = self._span(event)
            found = _WRITTEN_TAG.search(self._source.text, span.start, span.end)
            tag = Span(self._source, *found.span()) if found else span
            self._problems.error(explain_syntax.tag, tag, found[0] if found else event.tag)

    def _scalar(self, event: yaml.ScalarEvent) -> ScalarNode:
        span = self._value_span(event)
        text = _carried(event.value, span, self._problems)
        if event.style or not event.implicit[0]:
            return ScalarNode(text, span, plain=False)
        return self._plain(text, span)

    def _plain(self, text: str, span: Span) -> ScalarNode:
        tag = str(_RESOLVER.resolve(yaml.ScalarNode, text, (True, False))).removeprefix(_TAG)  # type: ignore[no-untyped-call]
        return ScalarNode(self._value(tag, text, span), span, written=text)

    def _value(self, tag: str, text: str, span: Span) -> str | int | float | bool | Foreign | None:
        node = yaml.ScalarNode(tag, text)
        try:
            match tag:
                case "null":
                    return None
                case "bool":
                    return _CONSTRUCTOR.construct_yaml_bool(node)
                case "int" | "float" if ":" in text:
                    return Foreign("a number in base 60")  # people and nodes read 1:30 as a text
                case "int":
                    value = int(_CONSTRUCTOR.construct_yaml_int(node))
                    if _LEADING_ZERO.fullmatch(text) and int(text, 10) != value:
                        self._problems.error(explain_syntax.unclear_number, value, span, text)
                    return value
                case "float":
                    return float(_CONSTRUCTOR.construct_yaml_float(node))
                case "timestamp":
                    return Foreign("a date")
                case "value":
                    self._problems.error(explain_syntax.reserved, span, text)
                    return text
                case _:
                    return text
        except ValueError:  # an integer of thousands of digits, `0b`, `0x_`
            self._problems.error(explain_syntax.bad_number, span, shorten(text))
            return 0

    def _closed(self, opened: _Open, end: yaml.Event) -> ListNode | MapNode:
        size = 1 + sum(size_of(value) for value in opened.values)
        if isinstance(opened.start, yaml.SequenceStartEvent):
            return ListNode(tuple(opened.values), self._span(opened.start, end), size)
        keys, values = opened.values[::2], opened.values[1::2]
        entries: dict[str, tuple[Key, Node]] = {}
        merged: list[MapNode] = []
        for key, value in zip(keys, values, strict=True):
            if isinstance(key, ScalarNode) and key.value == "<<" and key.plain:
                merged += self._merged(value)
                continue
            if isinstance(value, ScalarNode) and value.value == "<<" and value.plain:
                self._problems.error(explain_syntax.reserved, value.span, "<<")
            name = self._key(key)
            if name is None:
                continue
            if name.name in entries:
                self._problems.error(explain_syntax.duplicate_key, name, entries[name.name][0])
            else:
                entries[name.name] = (name, value)
        for key_and_value in chain.from_iterable(other.entries for other in merged):
            entries.setdefault(key_and_value[0].name, key_and_value)
        return MapNode(tuple(entries.values()), self._span(opened.start, end), size)

    def _merged(self, value: Node) -> list[MapNode]:
        """The maps that a merge key `<<` brings in: one, or a list of them."""
        maps = value.items if isinstance(value, ListNode) else (value,)
        found = [item for item in maps if isinstance(item, MapNode)]
        if len(found) < len(maps):
            self._problems.error(explain_syntax.merge_key, value.span)
        return found

    def _key(self, node: Node) -> Key | None:
        if isinstance(node, ScalarNode) and isinstance(node.value, str):
            return Key(node.value, node.span)
        self._problems.error(explain_syntax.no_text_key, node)
        return None

    def _span(self, start: yaml.Event, end: yaml.Event | None = None) -> Span:
        return Span(self._source, *_range(start, end or start))

    def _value_span(self, event: yaml.ScalarEvent) -> Span:
        """The place of the value itself, without tag and anchor, up to the end of its first line."""
        start, end = _range(event, event)
        text = self._source.text
        while start < end and text[start] in "!&":
            start += len(text[start:end].split(None, 1)[0])
            start = end - len(text[start:end].lstrip())
        first_line = text[start:end].split("\n", 1)[0].rstrip()
        return Span(self._source, start, start + len(first_line))


class _JsonComposer(_Composer):
    """The same from JSON."""

    def _events(self) -> Iterator[yaml.Event]:
        text = self._source.text
        start = 1 if text.startswith("\ufeff") else 0
        problem = self._problem(start) if text[start:].strip(" \t\r\n") else None
        for token in _JSON_TOKEN.finditer(text, start):
            if problem is not None and token.end() > problem[0]:
                break
            begin, end = (yaml.Mark("", at, 0, 0, None, 0) for at in token.span())
            match token[0][0]:
                case "{":
                    yield yaml.MappingStartEvent(None, None, True, begin, end)
                case "[":
                    yield yaml.SequenceStartEvent(None, None, True, begin, end)
                case "}":
                    yield yaml.MappingEndEvent(begin, end)
                case "]":
                    yield yaml.SequenceEndEvent(begin, end)
                case '"':
                    yield yaml.ScalarEvent(None, None, (False, True), json.loads(token[0]), begin, end, '"')
                case _:
                    yield yaml.ScalarEvent(None, None, (True, False), token[0], begin, end)
        if problem is not None:
            raise UnreadableError(_no_json(problem[1], problem[0], self._source))

    def _problem(self, start: int) -> tuple[int, str] | None:
        """The place from which on a text is no JSON, and the words of the standard library for that."""
        text = self._source.text
        constants: list[str] = []
        problem: tuple[int, str] | None = None
        try:
            json.loads(text[start:], parse_int=str, parse_float=str, parse_constant=constants.append)
        except json.JSONDecodeError as error:
            problem = start + error.pos, error.msg
        except RecursionError:
            pass  # the composer finds the place where it is too deep
        if constants:  # NaN and Infinity, which are JSON to Python
            words = (
                token for token in _JSON_TOKEN.finditer(text, start) if token[0].startswith(constants[0])
            )
            return next(words).start(), "Expecting value"
        return problem

    def _plain(self, text: str, span: Span) -> ScalarNode:
        try:
            return ScalarNode(json.loads(text), span)
        except ValueError:  # an integer of thousands of digits
            self._problems.error(explain_syntax.bad_number, span, shorten(text))
            return ScalarNode(0, span)


def _no_json(message: str, at: int, source: Source) -> Diagnostic:
    """An error of the standard library, in our words."""
    text = source.text
    if message.startswith(
        "Illegal trailing comma"
    ):  # CPython 3.13 names the comma, not what is missing after it
        at = len(text) - len(text[at + 1 :].lstrip(" \t\r\n"))
        message = "Expecting property name" if text[at] == "}" else "Expecting value"
    for theirs, ours in _JSON_ERRORS.items():
        if message.startswith(theirs):
            message = ours
    if message.startswith("Expecting ','"):
        opened: list[int] = []
        for token in _JSON_TOKEN.finditer(text, 0, at):
            if token[0] in "[{":
                opened.append(token.start())
            elif token[0] in "]}":
                opened.pop()
        closing = "}" if text[opened[-1]] == "{" else "]"
        line = source.position(opened[-1])[0]
        message = f"`,` or `{closing}` belongs here, for what was opened on line {line}"
    message = message[:1].lower() + message[1:].removesuffix(" at")
    at = min(at, len(text))
    return explain_syntax.syntax("JSON", message, Span(source, at, at + 1))


def _range(first: yaml.Event, last: yaml.Event) -> tuple[int, int]:
    assert first.start_mark is not None and last.end_mark is not None
    return first.start_mark.index, last.end_mark.index


def _syntax(error: yaml.YAMLError, source: Source) -> Diagnostic:
    if isinstance(error, yaml.reader.ReaderError):
        place = min(int(error.position), len(source.text))
        code = ord(source.text[place]) if place < len(source.text) else 0
        return explain_syntax.no_yaml_character(Span(source, place, place + 1), code)
    if not isinstance(error, yaml.MarkedYAMLError) or error.problem_mark is None:
        return explain_syntax.syntax("YAML", str(error), Span(source, 0, 0))
    # A part that is missing at the end of the file is shown after its last word.
    place = error.problem_mark.index
    place = place if source.text[place:].strip() else len(source.text.rstrip())
    label = Span(source, place, place + 1)
    if source.text[place : place + 1] == "\t":
        return explain_syntax.tab(label)
    context = None
    if error.context_mark is not None and error.context_mark.index < place:
        start = error.context_mark.index
        context = Label(Span(source, start, start + 1), error.context or "")
    return explain_syntax.syntax("YAML", error.problem or "it cannot be read", label, context)


def _carried(text: str, span: Span, problems: FileProblems) -> str:
    """The text, with what no string of ROS can hold replaced and reported: NUL, and half of a character."""
    if "\0" in text:
        problems.error(explain_syntax.nul, span)
        text = text.replace("\0", "\ufffd")
    if _SURROGATE.search(text):
        problems.error(explain_syntax.surrogate, span)
        text = _SURROGATE.sub("\ufffd", text)
    return text
