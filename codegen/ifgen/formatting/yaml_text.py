"""The style of NoDL in YAML: two spaces before a comment behind a value, one after `#`, one after `key:`.

Indentation and everything within a text of several lines stays.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final

import yaml

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import InputError, Source
from ifgen.formatting.lines import tidy_lines
from ifgen.nodl.syntax import reader

_BARE_COMMENT: Final = re.compile(r"#(?=[^\s#!])")
"""A `#` with text right behind it; `#!` says which program reads the file."""


def formatted(source: Source) -> str:
    """The text of a document in YAML in our style."""
    refuse_mistakes(source)
    inner, comments, gaps = _looked_at(source.text)
    lines = source.text.splitlines()
    aligned = _aligned(gaps)
    for number, line in enumerate(lines):
        column = comments.get(number)
        code, comment = (line, "") if column is None else (line[:column], line[column:])
        if number in gaps and number not in aligned:
            start, end = gaps[number]
            code = f"{code[:start]} {code[end:]}"
        code = code if number in inner else code.rstrip()
        if comment:
            comment = _BARE_COMMENT.sub("# ", comment, count=1).rstrip()
            code = f"{code}  {comment}" if code else " " * (column or 0) + comment
        lines[number] = code
    return _joined(lines, inner)


def refuse_mistakes(source: Source) -> None:
    """Raise InputError if a document, in YAML or JSON, cannot be read."""
    problems = FileProblems(source)
    try:
        reader.parse(source, problems)
    except reader.UnreadableError as error:
        raise InputError([error.diagnostic]) from None
    if problems:
        raise InputError(problems.errors())


def meaning(source: Source) -> object:
    """The nodes of a document, and the texts of its comments."""
    lines = source.text.splitlines()
    comments = [lines[number][column:].strip("# ") for number, column in _looked_at(source.text)[1].items()]
    return _value(yaml.compose(source.text, yaml.SafeLoader)), comments


def _looked_at(text: str) -> tuple[set[int], dict[int, int], dict[int, tuple[int, int]]]:
    """The lines that end within a text, where comments start, and the space between key and value."""
    inner: set[int] = set()
    gaps: dict[int, tuple[int, int]] = {}
    comments: dict[int, int] = {}
    lines = text.splitlines()
    last = (0, 0)  # the end of the last token
    after_key = False
    for token in yaml.scan(text, yaml.SafeLoader):
        start: tuple[int, int] = (token.start_mark.line, token.start_mark.column)
        comments.update(_comments(lines, last, start))
        if after_key and last[0] == start[0] and start[1] > last[1] + 1:
            gaps[start[0]] = (last[1], start[1])
        last = (token.end_mark.line, token.end_mark.column)
        after_key = isinstance(token, yaml.ValueToken)
        if isinstance(token, yaml.ScalarToken):
            if token.style in {"|", ">"}:
                header: str = lines[start[0]]
                at = header.find("#", start[1])
                if at >= 0:
                    comments[start[0]] = at
                inner.update(range(start[0] + 1, last[0]))
            else:
                inner.update(range(start[0], last[0]))
    comments.update(_comments(lines, last, (len(lines), 0)))
    return inner, comments, gaps


def _comments(lines: list[str], start: tuple[int, int], end: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """The line and column of each comment between two tokens."""
    for number in range(start[0], min(end[0] + 1, len(lines))):
        left = start[1] if number == start[0] else 0
        right = end[1] if number == end[0] else len(lines[number])
        at = lines[number].find("#", left, right)
        if at >= 0:
            yield number, at


def _aligned(gaps: dict[int, tuple[int, int]]) -> set[int]:
    """The lines whose values stand in one column with those of a neighbour."""
    return {
        number
        for number, (_, end) in gaps.items()
        if any(gaps.get(other, (0, 0))[1] == end for other in (number - 1, number + 1))
    }


def _joined(lines: list[str], inner: set[int]) -> str:
    """The lines as a text; those within a text stay, however many of them are empty."""
    text = ""
    rest: list[str] = []
    for number, line in enumerate(lines):
        if number in inner:
            text += _tidy_part(rest, text) + f"{line}\n"
            rest = []
        else:
            rest.append(line)
    return text + _tidy_part(rest, text)


def _tidy_part(lines: list[str], before: str) -> str:
    """Lines as a text, of which an empty one may come first if there is something before them."""
    text = tidy_lines(lines)
    return f"\n{text}" if before and lines and not lines[0].strip() and text else text


def _value(node: Any) -> object:
    """A node of YAML as plain data."""
    if isinstance(node, yaml.MappingNode):
        return node.tag, [(_value(key), _value(value)) for key, value in node.value]
    if isinstance(node, yaml.SequenceNode):
        return node.tag, [_value(each) for each in node.value]
    return (node.tag, node.value) if node is not None else None
