"""Text of others, for a terminal."""

from __future__ import annotations


def printable(text: str) -> str:
    """The text with a question mark in place of all that could control a terminal or end a line."""
    return text if text.isprintable() else "".join(each if each.isprintable() else "?" for each in text)


def printable_lines(text: str) -> str:
    """The same for a text of several lines."""
    return text if text.isprintable() else "\n".join(map(printable, text.split("\n")))
