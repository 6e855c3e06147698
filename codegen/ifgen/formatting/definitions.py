"""The style of .msg, .srv and .action files.

One space between type, name and value, two before a comment behind them. Columns that people have aligned
over several lines stay aligned, as narrow as their contents allow.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Final

from ifgen.config.suppressions import without_directive
from ifgen.diagnostics import InputError, Source
from ifgen.formatting.lines import tidy_lines
from ifgen.idl import parser
from ifgen.idl.comments import documentation
from ifgen.idl.tree import ConstantNode, DefinitionNode, InterfaceTree

_PARSERS: Final = {
    ".msg": parser.parse_message,
    ".srv": parser.parse_service,
    ".action": parser.parse_action,
}
_TAB: Final = 8
"""Columns from one tab stop to the next, to see what looks aligned."""
_HASHES: Final = re.compile("#+")
_PLAIN_LIST: Final = re.compile(r"\[[^\[\]'\"]*\]")


@dataclass
class _Line:
    """A line with a definition (`parts`), a comment, both, or a separator or annotation (`other`).

    `columns` are where the name, the value and the comment stand in the file, as far as the line has them.
    """

    parts: list[str] = field(default_factory=list[str])
    sign: str = " "
    comment: str | None = None
    indentation: int = 0
    other: str = ""
    columns: dict[str, int] = field(default_factory=dict[str, int])

    @property
    def is_definition(self) -> bool:
        return bool(self.parts)

    @property
    def continues(self) -> bool:
        """Whether it holds only an indented comment, which belongs to the definition above."""
        return not self.parts and self.comment is not None and self.indentation > 0


def formatted(source: Source) -> str:
    """The text of an interface file in our style."""
    lines = _lines(source, _tree(source))
    _space_comments(lines)
    for block in _blocks(lines):
        _align(block)
    text = tidy_lines(map(_text, lines))
    # An empty line at the start makes the comment below it that of the first definition.
    starts_empty = bool(lines) and not lines[0].other and not lines[0].parts and lines[0].comment is None
    return f"\n{text}" if starts_empty and text.startswith("#") else text


def meaning(source: Source) -> object:
    """Types, names, values and documentation, of each part in order."""
    return [
        (
            documentation(part.comments),
            [
                (node.type_text, node.name, _value(node), type(node), documentation(node.comments))
                for node in part.definitions
            ],
            len(part.optionals),
        )
        for part in _tree(source).parts
    ]


def _tree(source: Source) -> InterfaceTree:
    tree = _PARSERS[source.path.suffix](source)
    if tree.problems:
        raise InputError(tree.problems)
    return tree


def _value(node: DefinitionNode) -> str | None:
    """A value as it is written; lists without quotes have one space after each comma."""
    value = node.value
    if value is None or not _PLAIN_LIST.fullmatch(value):
        return value
    elements = [element.strip() for element in value[1:-1].split(",")]
    return f"[{', '.join(elements)}]" if all(elements) else value


def _lines(source: Source, tree: InterfaceTree) -> list[_Line]:
    """The lines of a file."""
    nodes = {source.position(node.type_start)[0]: node for part in tree.parts for node in part.definitions}
    texts = source.text.splitlines(keepends=True)
    start = 0
    lines: list[_Line] = []
    for number, raw in enumerate(texts, 1):
        node = nodes.get(number)
        lines.append(_plain(raw) if node is None else _definition(raw, start, node))
        start += len(raw)
    return lines


def _plain(raw: str) -> _Line:
    """A line without a definition."""
    text = raw.expandtabs(_TAB)
    before, sign, _ = text.partition("#")
    if not sign:
        return _Line(other=text.strip())
    comment = raw[raw.index("#") :].replace("\t", " ").rstrip()
    return _Line(other=before.strip(), comment=comment, indentation=len(before))


def _definition(raw: str, start: int, node: DefinitionNode) -> _Line:
    """A line with a definition; `start` is where the line starts in the file."""
    value = _value(node)
    name_end = node.name_start + len(node.name)
    end = name_end if node.value is None else node.value_start + len(node.value)
    optional = raw[: node.type_start - start].strip()
    parts = [f"{optional} {node.type_text}" if optional else node.type_text, node.name]
    places = {"name": node.name_start}
    sign = " "
    if value is not None:
        parts.append(value)
        if isinstance(node, ConstantNode):
            sign = " = "
            places["value"] = start + raw.index("=", name_end - start)
        else:
            places["value"] = node.value_start
    comment = None
    hash_at = raw.find("#", end - start)
    if hash_at >= 0:
        comment = raw[hash_at:].replace("\t", " ").rstrip()
        places["comment"] = start + hash_at
    columns = {what: len(raw[: place - start].expandtabs(_TAB)) for what, place in places.items()}
    return _Line(parts, sign, comment, columns=columns)


def _space_comments(lines: Sequence[_Line]) -> None:
    """Put a space after the `#` of comments, if a whole comment has none.

    In a comment with both forms the text behind `# ` is indented, and that means something.
    """
    for owned in _comments_by_owner(lines):
        texts = [line for line in owned if line.comment and without_directive(line.comment).strip("# ")]
        if all(not _text_of(line).startswith(" ") for line in texts):
            for line in texts:
                assert line.comment is not None
                hashes = line.comment[: len(line.comment) - len(_text_of(line))]
                line.comment = f"{hashes} {_text_of(line)}"


def _text_of(line: _Line) -> str:
    assert line.comment is not None
    return _HASHES.sub("", line.comment, count=1)


def _comments_by_owner(lines: Sequence[_Line]) -> Iterator[list[_Line]]:
    """The lines with comments that are read together: as those of a message, or of a definition."""
    own: list[_Line] = []
    following: list[_Line] = []
    leading = True
    for line in lines:
        if line.other == "---":
            yield from (own, following)
            own, following, leading = [], [], True
            continue
        if leading and (line.indentation or line.comment is None or line.is_definition):
            yield own
            own, leading = [], False
        if line.is_definition:
            if own is not following:
                yield own
            own, following = following, []
        elif line.other and own is not following:  # `@optional`: all that follows is about what is optional
            yield own
            own = following
        if line.comment is not None:
            (own if leading or line.indentation or line.is_definition else following).append(line)
    yield from (own, following)


def _blocks(lines: Sequence[_Line]) -> Iterator[list[_Line]]:
    """Definitions in consecutive lines, with the indented comments below each."""
    block: list[_Line] = []
    for line in lines:
        if line.is_definition or (line.continues and block):
            block.append(line)
        elif block:
            yield block
            block = []
    if block:
        yield block


def _align(block: Sequence[_Line]) -> None:
    """Put the columns of a block where our style has them."""
    definitions = [line for line in block if line.is_definition]
    for run in _runs(definitions, "name"):
        _pad(run, 0)
    for run in _runs(definitions, "value"):
        _pad(run, 1)
    for run in _runs(definitions, "comment"):
        column = max(len(_code(line)) for line in run) + 2
        for line in run:
            line.indentation = column
    above: _Line | None = None
    for line in block:
        if line.is_definition:
            above = line
        elif above is not None and line.indentation == above.columns.get("comment"):
            line.indentation = above.indentation


def _runs(lines: Sequence[_Line], what: str) -> Iterator[list[_Line]]:
    """Neighbours, of those that have it, with something in the same column; one alone is a run too."""
    having = [line for line in lines if what in line.columns]
    for _, run in groupby(having, key=lambda line: line.columns[what]):
        yield list(run)


def _pad(run: Sequence[_Line], part: int) -> None:
    """Make the lines equally long up to the end of a part."""
    lengths = [len(" ".join(line.parts[: part + 1])) for line in run]
    for line, length in zip(run, lengths, strict=True):
        line.parts[part] += " " * (max(lengths) - length)


def _code(line: _Line) -> str:
    """The definition of a line."""
    head = " ".join(line.parts[:2])
    return f"{head}{line.sign}{line.parts[2]}".rstrip() if len(line.parts) == 3 else head.rstrip()


def _text(line: _Line) -> str:
    """A line in our style."""
    if not line.is_definition:
        if line.comment is None:
            return line.other
        return f"{line.other}  {line.comment}" if line.other else " " * line.indentation + line.comment
    if line.comment is None:
        return _code(line)
    return f"{_code(line):<{line.indentation}}{line.comment}"
