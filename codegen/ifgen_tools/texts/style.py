"""How messages are shown, as the user chose it on the command line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any, Final

import click


@dataclass(frozen=True, slots=True)
class Style:
    """The style in which a message is shown.

    `longest` is the length after which arrays, strings and bytes are cut (None: never). `no_arr` and `no_str`
    put the type and the length in place of arrays and strings. `flow` writes lists in one line.
    """

    longest: int | None = None
    no_arr: bool = False
    no_str: bool = False
    flow: bool = False

    def fits(self, value: Any) -> bool:
        """True if a text or an array is not cut."""
        return self.longest is None or len(value) <= self.longest


WHOLE: Final = Style()
"""The style that shows all of a message."""


def style_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of the verbs that print messages, as `style`."""

    @wraps(command)
    def run(
        full_length: bool, truncate_length: int, no_arr: bool, no_str: bool, flow_style: bool, **values: Any
    ) -> Any:
        style = Style(None if full_length else truncate_length, no_arr, no_str, flow_style)
        return command(style=style, **values)

    for option in (
        click.option("--flow-style", is_flag=True, help="Lists in one line."),
        click.option("--no-str", is_flag=True, help="No strings: their length in their place."),
        click.option("--no-arr", is_flag=True, help="No arrays: their type and length in their place."),
        click.option(
            "-l",
            "--truncate-length",
            type=click.IntRange(min=0),
            default=128,
            metavar="N",
            help="The length after which these are cut, 128 by default.",
        ),
        click.option("-f", "--full-length", is_flag=True, help="Long arrays, strings and bytes as a whole."),
    ):
        option(run)  # which is changed in place
    return run
