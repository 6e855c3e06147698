"""The verbs of `ifgen topic`, which read their options and leave the work to other modules."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import click
from ifgen.command_kit import options
from ifgen.command_kit.completion import message_types
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion, qos
from ifgen_tools.texts.style import style_options
from ifgen_tools.topic.options import EchoOptions, HzOptions, PubOptions, RateOptions
from ifgen_tools.verbs import FindOptions, ListOptions, NameOptions, takes

# Late imports: each verb loads what it needs.

_POSITIVE: Final = click.FloatRange(min=0, min_open=True)
_TOPIC: Final = click.argument("name", metavar="TOPIC", shell_complete=completion.topics)


def _window(default: int) -> Callable[[options.Command], options.Command]:
    return click.option(
        "-w",
        "--window",
        type=click.IntRange(min=1),
        default=default,
        metavar="N",
        help=f"How many messages the figures are about, {default} by default.",
    )


@click.group(cls=ToolGroup)
def topic() -> None:
    """Look at topics, listen to them, and publish."""


@topic.command("list", epilog="Example: ifgen topic list -t")
@options.hidden_topics_option
@click.option("-t", "--show-types", is_flag=True, help="The types as well.")
@click.option("-c", "--count-topics", "--count", "count", is_flag=True, help="Only how many there are.")
@click.option("-v", "--verbose", is_flag=True, help="The numbers of publishers and subscribers as well.")
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(ListOptions)
def list_(chosen: ListOptions) -> int:
    """Print the names of all topics."""
    from ifgen_tools.topic.list import list_topics

    return list_topics(chosen)


@topic.command(epilog="Example: ifgen topic info -v /chatter")
@_TOPIC
@click.option("-v", "--verbose", is_flag=True, help="Each endpoint: its node, type hash, GID and QoS.")
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(NameOptions)
def info(chosen: NameOptions) -> int:
    """Print the type of a topic, and who publishes and subscribes."""
    from ifgen_tools.topic.list import info as run

    return run(chosen)


@topic.command("type", epilog="Example: ifgen topic type /chatter")
@_TOPIC
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(NameOptions)
def type_(chosen: NameOptions) -> int:
    """Print the type of a topic."""
    from ifgen_tools.topic.list import type_ as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic find std_msgs/msg/String")
@click.argument("type_name", metavar="TYPE", shell_complete=message_types)
@click.option("-c", "--count-topics", "count", is_flag=True, help="Only how many there are.")
@options.hidden_topics_option
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(FindOptions)
def find(chosen: FindOptions) -> int:
    """Print the topics of a type."""
    from ifgen_tools.topic.list import find as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic echo /imu --field linear_acceleration --once")
@_TOPIC
@click.argument("message_type", metavar="[TYPE]", required=False, shell_complete=message_types)
@click.option("--once", is_flag=True, help="Print one message, and exit.")
@click.option("--timeout", type=_POSITIVE, metavar="SECONDS", help="Exit after this time.")
@click.option(
    "--field",
    "fields",
    multiple=True,
    metavar="PATH",
    help="Only this field, such as pose.position.x or poses[0].x.",
)
@click.option(
    "--filter",
    "filter_expression",
    metavar="EXPRESSION",
    help="Only if this Python expression holds, where m is the message, or the field: m.data > 0.5",
)
@click.option("--csv", is_flag=True, help="All values with commas between them.")
@click.option("--json", "as_json", is_flag=True, help="Each message as one line of JSON.")
@click.option("--raw", is_flag=True, help="The serialized bytes.")
@style_options
@click.option("-i", "--include-message-info", is_flag=True, help="Times and numbers of each message as well.")
@click.option("--no-lost-messages", is_flag=True, help="Do not say when a message is lost.")
@click.option(
    "--lost-messages", is_flag=True, expose_value=False, help="Accepted, as in ROS: it does nothing."
)
@qos.qos_options
@options.use_sim_time_option
@options.graph_options
@takes(EchoOptions)
def echo(chosen: EchoOptions) -> int:
    """Print the messages of a topic.

    TYPE is that of the topic if it is left out. Without --qos-... options, QoS fits all publishers that are
    there.
    """
    from ifgen_tools.topic.echo import echo as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}}'")
@_TOPIC
@click.argument("message_type", metavar="TYPE", shell_complete=message_types)
@click.argument("values", metavar="[VALUES]", required=False)
@click.option("--stdin", is_flag=True, help="Read VALUES from standard input.")
@click.option("-r", "--rate", type=_POSITIVE, default=1.0, metavar="HZ", help="The rate, 1 Hz by default.")
@click.option("-1", "--once", is_flag=True, help="Publish once.")
@click.option("-t", "--times", type=click.IntRange(min=0), metavar="N", help="Publish N times.")
@click.option(
    "-p",
    "--print",
    "print_every",
    type=click.IntRange(min=0),
    default=1,
    metavar="N",
    help="Print only each N-th message; 0 prints none.",
)
@click.option(
    "-w",
    "--wait-matching-subscriptions",
    "wait_matching",
    type=click.IntRange(min=0),
    metavar="N",
    help="Wait for N subscriptions before; 1 by default with --once and --times, else 0.",
)
@click.option(
    "--max-wait-time-secs", "max_wait", type=_POSITIVE, metavar="SECONDS", help="But no longer than that."
)
@click.option(
    "--keep-alive",
    type=_POSITIVE,
    default=0.1,
    metavar="SECONDS",
    help="Stay so long after the last message, 0.1 s by default.",
)
@click.option("-n", "--node-name", metavar="NAME", help="The name of the publishing node.")
@qos.qos_options
@options.use_sim_time_option
@options.graph_options
@takes(PubOptions)
def pub(chosen: PubOptions) -> int:
    """Publish a message on a topic, again and again.

    VALUES are YAML. Fields that they do not mention have their default values. `auto` for a header and `now`
    for a time stand for the time of sending.
    """
    from ifgen_tools.topic.pub import pub as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic hz /imu /scan --window 100")
@click.argument("names", metavar="TOPIC...", nargs=-1, required=True, shell_complete=completion.topics)
@_window(10_000)
@click.option(
    "--filter",
    "filter_expression",
    metavar="EXPRESSION",
    help="Only messages for which this Python expression holds, where m is the message.",
)
@click.option("--wall-time", is_flag=True, help="By the time of the machine, also if time is simulated.")
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(HzOptions)
def hz(chosen: HzOptions) -> int:
    """Print the rates of topics, every second."""
    from ifgen_tools.topic.rates import hz as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic bw /camera/image")
@_TOPIC
@_window(100)
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(RateOptions)
def bw(chosen: RateOptions) -> int:
    """Print the bandwidth of a topic, every second."""
    from ifgen_tools.topic.rates import bw as run

    return run(chosen)


@topic.command(epilog="Example: ifgen topic delay /imu")
@_TOPIC
@_window(10_000)
@options.json_option
@options.use_sim_time_option
@options.graph_options
@takes(RateOptions)
def delay(chosen: RateOptions) -> int:
    """Print how old messages are by their headers, every second."""
    from ifgen_tools.topic.rates import delay as run

    return run(chosen)
