"""Arguments and options that several commands share, with their help."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from ifgen.reading.storage import near_paths


class _Existing(click.Path):
    """A path that exists. If it does not, the error names those beside it that look alike."""

    def __init__(self, *, file_okay: bool = True, dir_okay: bool = True) -> None:
        super().__init__(exists=True, file_okay=file_okay, dir_okay=dir_okay, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            if not (near := near_paths(value)):
                raise
            self.fail(f"{error.message} Did you mean {' or '.join(map(repr, near))}?", param, ctx)


EXISTING = _Existing()
EXISTING_FILE = _Existing(dir_okay=False)
FOLDER = _Existing(file_okay=False)
OUTPUT_FOLDER = click.Path(file_okay=False, path_type=Path)
OUTPUT_FILE = click.Path(dir_okay=False, path_type=Path)


def include(command: Callable[..., Any]) -> Callable[..., Any]:
    """`-I DIR`, which may be repeated."""
    help = "Also look for dependencies in this folder; may be repeated."
    return click.option("-I", "--include", metavar="DIR", multiple=True, type=FOLDER, help=help)(command)


def strict(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--strict` and `--no-strict`."""
    help = "Treat warnings as errors: exit with 1."
    return click.option("--strict/--no-strict", default=None, help=help)(command)


def quiet(command: Callable[..., Any]) -> Callable[..., Any]:
    """`-q`."""
    return click.option("-q", "--quiet", is_flag=True, help="Print only diagnostics.")(command)


def format_(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--format text|json|github`, for diagnostics."""
    help = "For people (text), tools (json) or annotations on GitHub."
    choice = click.Choice(["text", "json", "github"])
    return click.option("--format", "format_", type=choice, default="text", help=help)(command)


def transport(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--transport local|rclpy|auto`; the variable IFGEN_TRANSPORT, where it is set, is the default."""
    help = "Our rclpy (local), the real one (rclpy), or the real one if it is installed (auto, the default)."
    choice = click.Choice(["local", "rclpy", "auto"])
    return click.option("--transport", type=choice, default="auto", envvar="IFGEN_TRANSPORT", help=help)(
        command
    )


class WithDepsCommand(click.Command):
    """A command with `--with-deps`, whose value is written with a `=` or left out: what follows is a PATH."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Give the option the value that it stands for where it is written without one."""
        words = {"--with-deps": "--with-deps=all", "--no-with-deps": "--with-deps=none"}
        return super().parse_args(ctx, [words.get(word, word) for word in args])


class _Dependencies(click.Choice[str]):
    """`--with-deps` as the configuration has it: true, false or "own"."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if isinstance(value, bool):
            return value
        chosen = super().convert(value, param, ctx)
        return chosen if chosen == "own" else chosen == "all"


def with_deps(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--with-deps`, `--with-deps=own` and `--no-with-deps`, for a WithDepsCommand."""
    help = "Also write the dependencies; own: only those that -I finds. --no-with-deps: none."
    choice = _Dependencies(["all", "own", "none"])
    return click.option("--with-deps", metavar="[=own]", default=None, type=choice, help=help)(command)
