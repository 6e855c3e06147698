"""The style of .idl files and of NoDL in JSON: two columns a bracket; within a line nothing moves."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, cast

from ifgen.diagnostics import InputError, Source
from ifgen.formatting.lines import tidy_lines
from ifgen.formatting.yaml_text import refuse_mistakes
from ifgen.idl.omg_parser import parse_idl

_INDENTATION: Final = 2
_IDL_TOKEN: Final = re.compile(
    r"""(?P<comment>//[^\n]*|/\*[\s\S]+?\*/)|"(?:[^"\\\n]|\\[^\n])*"|'(?:[^'\\\n]|\\[^\n])+'|(?P<sign>[^\s\w])"""
)
_JSON_TOKEN: Final = re.compile(r'(?P<comment>(?!))|"(?:[^"\\]|\\.)*"|(?P<sign>[^\s\w])')
_PLACES: Final = frozenset(("start", "end"))


def formatted_idl(source: Source) -> str:
    """The text of an .idl file in our style."""
    problems = parse_idl(source).problems
    if problems:
        raise InputError(problems)
    return _indented(source.text, _IDL_TOKEN, "{", "}", further="([=")


def idl_meaning(source: Source) -> object:
    """The tree of an .idl file without places, and the texts of its comments."""
    comments = [match["comment"] for match in _IDL_TOKEN.finditer(source.text) if match["comment"]]
    texts = [[line.strip() for line in comment.splitlines()] for comment in comments]
    return [_without_places(node) for node in parse_idl(source).definitions], texts


def formatted_json(source: Source) -> str:
    """The text of a document in JSON in our style."""
    refuse_mistakes(source)
    return _indented(source.text, _JSON_TOKEN, "{[", "}]")


def json_meaning(source: Source) -> object:
    """The values of a document in JSON, in order."""
    return json.loads(source.text, object_pairs_hook=list, parse_float=str, parse_int=str)


@dataclass
class _State:
    """The open things at the start of a line: brackets, a value that is still to come, and a comment."""

    depth: int = 0
    inner: int = 0
    waits: bool = False


def _indented(text: str, token: re.Pattern[str], opening: str, closing: str, further: str = "") -> str:
    """The lines of a text, indented by its brackets.

    What goes on in the next line, after one of `further`, is indented by one step more.
    """
    lines: list[str] = []
    state = _State()
    position = 0
    tokens = [(m.start(), m.end(), m["sign"], bool(m["comment"])) for m in token.finditer(text)]
    number = 0
    for raw in text.splitlines(keepends=True):
        end = position + len(raw)
        content = raw.strip()
        in_comment = number > 0 and tokens[number - 1][3] and tokens[number - 1][1] > position
        closes = len(content) - len(content.lstrip(closing))
        steps = max(state.depth - closes, 0)
        if not closes and (state.inner or state.waits) and not content.startswith(")"):
            steps += 1
        if in_comment:
            lines.append(raw.rstrip())
        elif content.startswith("#"):
            lines.append(content)
        else:
            lines.append(" " * (_INDENTATION * steps) + content if content else "")
        while number < len(tokens) and tokens[number][0] < end:
            _, _, sign, is_comment = tokens[number]
            if not is_comment:
                _follow(state, sign, opening, closing, further)
            number += 1
        position = end
    return tidy_lines(lines)


def _follow(state: _State, sign: str | None, opening: str, closing: str, further: str) -> None:
    """Go on behind a token; `sign` is None for a text."""
    if sign is None:
        return
    state.waits = sign == "=" and "=" in further
    if sign in opening:
        state.depth += 1
    elif sign in closing:
        state.depth -= 1
    elif sign in further.replace("=", ""):
        state.inner += 1
    elif further and sign in ")]":
        state.inner -= 1


def _without_places(node: Any) -> Any:
    """A tree without the places of its nodes."""
    if hasattr(node, "_asdict"):
        return type(node).__name__, [
            _without_places(value) for name, value in node._asdict().items() if name not in _PLACES
        ]
    if isinstance(node, list | tuple):
        return [_without_places(each) for each in cast("Sequence[Any]", node)]
    return node
