"""Texts for the user in which a bag may have put anything: nothing in them steers a terminal."""

from __future__ import annotations

import sys

from ifgen.diagnostics import printable


def show(text: str) -> None:
    """Print what the user asked for."""
    print(printable(text))


def say(text: str) -> None:
    """Tell the user, beside what others may read from the output."""
    print(printable(text), file=sys.stderr, flush=True)


def warn(text: str) -> None:
    """Warn the user."""
    say(f"warning: {text}")


def inline(text: str) -> str:
    """A text without ends of lines."""
    return printable(text).replace("\n", "\N{SYMBOL FOR LINE FEED}")
