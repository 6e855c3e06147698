"""The errors of commands: for users who made a mistake, or whose system is not as expected."""

from __future__ import annotations

import click


class ToolError(click.ClickException):
    """Ends a command with `error: ...`, with `= help: ...` below it if there is advice, and with exit code 1.

    What is wrong on the command line itself is a click.UsageError, whose exit code is 2.
    """

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


class Absent(ToolError):
    """The error that a node, or what nodes have, is not there: it may be on the other transport."""


def did_you_mean(name: str, known: list[str]) -> str:
    """Advice that names what is spelled like `name`; empty if nothing is."""
    from difflib import get_close_matches  # only a mistake needs it

    near = get_close_matches(name, known, n=3, cutoff=0.5)
    return f"did you mean {' or '.join(map(repr, near))}?" if near else ""
