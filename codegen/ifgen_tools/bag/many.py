"""Options with several values after them, as `ros2 bag` has them: `--topics /imu /scan`."""

from __future__ import annotations

from typing import Any

import click


class ManyOption(click.Option):
    """An option that takes all values up to the next option. Its parameter is a tuple."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **{**kwargs, "multiple": True})


class ManyCommand(click.Command):
    """A command whose `ManyOption`s may have several values."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the name of an option before each of its values, which click understands."""
        names = {name for param in self.params if isinstance(param, ManyOption) for name in param.opts}
        spread: list[str] = []
        current = ""
        has_value = True
        for position, argument in enumerate(args):
            if argument == "--":
                spread += args[position:]
                break
            if argument in names:
                current, has_value = argument, False
            elif argument.startswith("-") and argument != "-":
                current = ""
                spread.append(argument)
            elif current:
                spread += [current, argument]
                has_value = True
            else:
                spread.append(argument)
            if not has_value and (position + 1 == len(args) or args[position + 1].startswith("-")):
                raise click.UsageError(f"Option '{current}' requires at least one value.", ctx)
        return super().parse_args(ctx, spread)
