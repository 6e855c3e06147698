"""Texts in documents: which ones ROS can carry, and how to write them so that all readers of YAML agree."""

from __future__ import annotations

import re
from typing import Final

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Span
from ifgen.nodl.syntax import explain

# Characters that YAML reads unchanged, neither folded nor stripped, both in PyYAML and in the libyaml of ROS.
_PLAIN: Final = "\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff"
_ESCAPED: Final = re.compile(f'[^{_PLAIN}]|["\\\\]')
_LEFT_OUT: Final = re.compile(f"[^{_PLAIN}]")
_SHORT: Final = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "\b": "\\b", "\f": "\\f"}
_SURROGATE: Final = re.compile("[\ud800-\udfff]")


def carried(text: str, span: Span, problems: FileProblems) -> str:
    """The text, with what no string of ROS can hold replaced and reported: NUL, and half of a character."""
    if "\0" in text:
        problems.error(explain.nul, span)
        text = text.replace("\0", "\ufffd")
    if _SURROGATE.search(text):
        problems.error(explain.surrogate, span)
        text = _SURROGATE.sub("\ufffd", text)
    return text


def needs_escapes(text: str) -> bool:
    """Whether YAML can hold the text in double quotes only."""
    return _LEFT_OUT.search(text) is not None


def quoted(text: str) -> str:
    """The text in double quotes, with escapes that JSON has too where it has them."""
    return f'"{_ESCAPED.sub(_escape, text)}"'


def comment(text: str) -> list[str]:
    """The lines of a comment with this text, without `#` and without what YAML has no place for."""
    return [_LEFT_OUT.sub("", line.expandtabs(4)) for line in text.splitlines()]


def _escape(match: re.Match[str]) -> str:
    return _SHORT.get(match[0]) or f"\\u{ord(match[0]):04x}"
