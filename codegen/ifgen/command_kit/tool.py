"""Tools among the commands: their errors, and groups of verbs that end as the tools of ROS end."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import click

from ifgen import diagnostics

_SIGINT: Final = 2
_SIGTERM: Final = 15


class ToolError(click.ClickException):
    """Ends a command with `error: ...`, with `= help: ...` below it if there is advice, and with exit code 1.

    What is wrong on the command line itself is a click.UsageError, whose exit code is 2.
    """

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


class Absent(ToolError):
    """The error that a node, or what nodes have, is not there: it may be on the other transport."""


def did_you_mean(name: str, candidates: Iterable[str], *, limit: int = 3, cutoff: float = 0.5) -> str:
    """Advice that names what is spelled like `name`; empty if nothing is."""
    return diagnostics.did_you_mean(name, candidates, limit=limit, cutoff=cutoff)


class ToolCommand(click.Command):
    """A click command that ends quietly when it is interrupted.

    The exit code is then the number of the signal, as that of `ros2` is.
    """

    ends_as_in_ros: Final = True
    """True if the command `ifgen` ends like this command, too, when interrupted before or after it."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run it, and return its exit code."""
        from ifgen.signals import Terminated, signals_raise  # late: `--help` does without

        with signals_raise() as interrupt:
            try:
                return super().invoke(ctx) or 0
            except KeyboardInterrupt as stop:
                raise click.exceptions.Exit(_SIGTERM if isinstance(stop, Terminated) else _SIGINT) from None
            except click.exceptions.Exit:
                raise
            except Exception as error:
                # rclpy is not imported for its exception: a verb without nodes may never load it.
                if interrupt.number or type(error).__name__ == "ExternalShutdownException":
                    raise click.exceptions.Exit(interrupt.number or _SIGTERM) from None
                raise


class ToolGroup(ToolCommand, click.Group):
    """A click group whose verbs end in this way."""
