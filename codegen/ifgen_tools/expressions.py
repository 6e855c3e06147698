"""Python expressions of users that choose messages: `m.data > 0.5`."""

from __future__ import annotations

import builtins
from collections.abc import Callable
from typing import Any

import click
from ifgen.command_kit.tool import ToolError


def condition(expression: str | None) -> Callable[[Any], bool]:
    """Whether a message, called `m` in the expression, is wanted; without an expression all are.

    Python's own names are there too, as in ROS: it is the user's own code. Raises click.UsageError if it is
    no expression; the function raises ToolError for what the expression raises.
    """
    if not expression:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise click.UsageError(f"--filter {expression!r} is no Python expression: {error}") from None

    def holds(message: Any) -> bool:
        try:
            return bool(eval(code, {"__builtins__": builtins, "m": message}))
        except Exception as error:  # of the user's own code
            reason = f"{type(error).__name__}: {error}"
            raise ToolError(f"--filter {expression!r} failed: {reason}", "the message is called m") from None

    return holds
