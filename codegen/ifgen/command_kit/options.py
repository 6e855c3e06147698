"""Arguments and options that several commands share, with their help."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import click

from ifgen.reading.storage import near_paths

Command: TypeAlias = Callable[..., Any]


class _Existing(click.Path):
    """A path that exists. If it does not, the error names those beside it that look alike."""

    def __init__(self, *, file_okay: bool = True, dir_okay: bool = True, allow_dash: bool = False) -> None:
        super().__init__(
            exists=True, file_okay=file_okay, dir_okay=dir_okay, allow_dash=allow_dash, path_type=Path
        )

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            if not (near := near_paths(value)):
                raise
            self.fail(f"{error.message} Did you mean {' or '.join(map(repr, near))}?", param, ctx)


EXISTING = _Existing()
EXISTING_OR_DASH = _Existing(allow_dash=True)
"""An existing path, or - for standard input."""
EXISTING_FILE = _Existing(dir_okay=False)
FOLDER = _Existing(file_okay=False)
OUTPUT_FOLDER = click.Path(file_okay=False, path_type=Path)
OUTPUT_FILE = click.Path(dir_okay=False, path_type=Path)


def include_option(command: Command) -> Command:
    """`-I DIR`, which may be repeated."""
    help = "Also look for dependencies in this folder; may be repeated."
    return click.option("-I", "--include", metavar="DIR", multiple=True, type=FOLDER, help=help)(command)


def strict_option(command: Command) -> Command:
    """`--strict` and `--no-strict`."""
    help = "Treat warnings as errors: exit with 1."
    return click.option("--strict/--no-strict", default=None, help=help)(command)


def quiet_option(command: Command) -> Command:
    """`-q`."""
    return click.option("-q", "--quiet", is_flag=True, help="Print only diagnostics.")(command)


def format_option(command: Command) -> Command:
    """`--format text|json|github`, for diagnostics."""
    help = "For people (text), tools (json) or annotations on GitHub."
    choice = click.Choice(["text", "json", "github"])
    return click.option("--format", "format_", type=choice, default="text", help=help)(command)


def transport_option(command: Command) -> Command:
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


def with_deps_option(command: Command) -> Command:
    """`--with-deps`, `--with-deps=own` and `--no-with-deps`, for a WithDepsCommand."""
    help = "Also write the dependencies; own: only those that -I finds. --no-with-deps: none."
    choice = _Dependencies(["all", "own", "none"])
    return click.option("--with-deps", metavar="[=own]", default=None, type=choice, help=help)(command)


def json_option(command: Command) -> Command:
    """`--json`, as `as_json`."""
    return click.option("--json", "as_json", is_flag=True, help="Print JSON, for tools.")(command)


def spin_time_option(command: Command) -> Command:
    """`--spin-time SECONDS`, as `spin_time`; None if it is not given. Pass it to `Session.discover`."""
    return click.option(
        "--spin-time",
        type=click.FloatRange(min=0),
        metavar="SECONDS",
        help="How long to wait for nodes to be discovered. The default is until the graph is known.",
    )(command)


def hidden_topics_option(command: Command) -> Command:
    """`--include-hidden-topics`, as `include_hidden`."""
    return click.option(
        "--include-hidden-topics", "include_hidden", is_flag=True, help="Hidden topics as well."
    )(command)


def hidden_nodes_option(command: Command) -> Command:
    """`--include-hidden-nodes`, as `include_hidden`."""
    return click.option(
        "--include-hidden-nodes", "include_hidden", is_flag=True, help="Hidden nodes as well."
    )(command)


def graph_options(command: Command) -> Command:
    """The options of every command that looks at the graph: --transport, --spin-time and --no-daemon."""
    return transport_option(spin_time_option(no_daemon_option(command)))


def no_daemon_option(command: Command) -> Command:
    """`--no-daemon`, which scripts for ROS pass: there never is a daemon here."""
    return click.option(
        "--no-daemon", is_flag=True, expose_value=False, help="Accepted, as in ROS: there is no daemon here."
    )(command)


def use_sim_time_option(command: Command) -> Command:
    """`-s`, `--use-sim-time`, as `use_sim_time`. Pass it to `open_session`."""
    return click.option(
        "-s", "--use-sim-time", is_flag=True, help="Take the time of the topic /clock as the current time."
    )(command)
