"""The command `ifgen top`, which reads its options and leaves the work to a view."""

from __future__ import annotations

from dataclasses import dataclass

import click
from ifgen.command_kit import options
from ifgen.command_kit.tool import ToolCommand

from ifgen_tools.verbs import SessionOptions, takes

# Late imports: each view loads what it needs.


@dataclass(frozen=True, slots=True, kw_only=True)
class TopOptions(SessionOptions):
    """The options of `ifgen top`; the period is in s."""

    once: bool
    web: bool
    port: int
    period: float
    view: str
    include_hidden: bool
    no_subscribe: bool


@click.command(
    cls=ToolCommand,
    epilog="Example: `ifgen top --once` prints topics, nodes, subscriptions and executors as they are now.",
)
@options.transport_option
@click.option("--once", is_flag=True, help="Print everything once, and end.")
@options.json_option
@click.option("--web", is_flag=True, help="Show a page on 127.0.0.1 instead, until Ctrl-C.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8008,
    show_default=True,
    help="Port of the page; 0: any free one.",
)
@click.option(
    "--period",
    type=click.FloatRange(min=0.2, max=60),
    default=1.0,
    show_default=True,
    metavar="SECONDS",
    help="Time between two looks.",
)
@click.option(
    "--view",
    type=click.Choice(["topics", "nodes", "subscriptions", "executors"]),
    default="topics",
    show_default=True,
    help="The table to begin with.",
)
@click.option("--include-hidden", is_flag=True, help="Hidden nodes, topics and services as well.")
@click.option(
    "--no-subscribe",
    is_flag=True,
    help="Subscribe to nothing: no bandwidth, and rates only where publishers tell them.",
)
@options.no_daemon_option
@takes(TopOptions)
def top(chosen: TopOptions) -> int:
    """Watch nodes, topics, subscriptions and executors as they run.

    It changes nothing, and subscribes only to the topics that are on the screen. How full queues are, what
    subscriptions have missed and how busy executors are is told by the processes of the local transport. Real
    rclpy has no way to ask for that, so these columns show "-" there.

    Keys: arrows to move and to choose the column, s to sort by it, tab for the next table, / to filter,
    p for the parameters of a node, ? for all of them, q to quit.
    """
    from ifgen_tools.top.run import run

    return run(chosen)
