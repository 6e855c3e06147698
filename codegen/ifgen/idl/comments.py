"""Comments: whose they are, what they say and which unit they name, all by rosidl_adapter's rules."""

from __future__ import annotations

from collections.abc import Sequence

from ifgen.config.suppressions import without_directive


def _comment(line: str) -> str | None:
    """The text after the `#` signs that open a line's comment; None where it has none for a reader."""
    line = line.rstrip()
    index = line.find("#")
    if index < 0:
        return None
    return text.lstrip("#") if (text := without_directive(line[index:])) else None


def split_end(text: str) -> tuple[list[str], list[str]]:
    """Divide the comments after a definition: its own, and those of the next definition.

    Its own are the one on its line and indented ones below; a comment in the first column belongs to what
    follows.
    """
    own: list[str] = []
    following: list[str] = []
    first, *rest = text.split("\n")
    comment = _comment(first)
    if comment is not None:
        own.append(comment)
    for line in rest:
        comment = _comment(line)
        if comment is not None:
            (following if line[0] == "#" else own).append(comment)
    return own, following


def split_lead(text: str) -> tuple[list[str], list[str]]:
    """Divide the comments at the start of a part: the message's own, and those of its first definition.

    The message's are the lines that start with `#`, up to the first other line. Indented ones are dropped.
    """
    own: list[str] = []
    following: list[str] = []
    target = own
    for line in text.split("\n"):
        if line.startswith("#"):
            comment = _comment(line)
            target += [] if comment is None else [comment]
        else:
            target = following
    return own, following


def documentation(comments: Sequence[str]) -> tuple[str, str | None]:
    """The text of comment lines and the unit that they name in brackets, if they name exactly one.

    The bracket is taken out of the text; empty lines at both ends go, several in a row become one, and the
    indentation that all lines share goes. A unit may hold a line break, if its bracket does.
    """
    if len(comments) == 1 and "[" not in comments[0]:
        return comments[0].strip(" "), None
    joined = "\n".join(comments)
    bracket = _only_bracket(joined) if "[" in joined else None
    if bracket is None:
        return _tidy(comments), None
    written, unit = bracket
    text = _tidy([line.replace(written, "") for line in comments])
    return text, unit


def _only_bracket(text: str) -> tuple[str, str] | None:
    """The one `[...]` without a comma, with the space before it, and its content; None if not exactly one."""
    found: tuple[str, str] | None = None
    start = 0
    while (end := text.find("]", start)) >= 0:
        opening = text.find("[", max(start, text.rfind(",", start, end) + 1), end)
        if opening >= 0 and opening + 1 < end:
            if found is not None:
                return None
            before = start + len(text[start:opening].rstrip())
            found = text[before : end + 1], text[opening + 1 : end]
        start = end + 1
    return found


def _tidy(lines: Sequence[str]) -> str:
    kept: list[str] = []
    for line in map(str.rstrip, lines):
        if line or (kept and kept[-1]):
            kept.append(line)
    if kept and not kept[-1]:
        kept.pop()
    margin = min((len(line) - len(line.lstrip(" ")) for line in kept if line), default=0)
    return "\n".join([line[margin:] for line in kept])
