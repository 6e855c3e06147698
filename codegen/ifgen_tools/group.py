"""The commands of tools, and groups of their verbs, which end as the tools of ROS end."""

from __future__ import annotations

from typing import Any, Final

import click

_SIGINT: Final = 2
_SIGTERM: Final = 15


class ToolCommand(click.Command):
    """A click command that ends quietly when it is interrupted.

    The exit code is then the number of the signal, as that of `ros2` is.
    """

    ends_as_in_ros: Final = True
    """What the command `ifgen` asks for if it is interrupted before this command, or after."""

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
