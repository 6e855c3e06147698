"""Options that several commands share, under the names that they have in ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import click

Command: TypeAlias = Callable[..., Any]


def transport_option(command: Command) -> Command:
    """`--transport local|rclpy|auto`, as `transport`; IFGEN_TRANSPORT is its default, as for `ifgen run`."""
    return click.option(
        "--transport",
        type=click.Choice(["local", "rclpy", "auto"]),
        default="auto",
        envvar="IFGEN_TRANSPORT",
        help="Our rclpy (local), the real one (rclpy), or the real one if there is one (auto, the default).",
    )(command)


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
