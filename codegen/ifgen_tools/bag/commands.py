"""The verbs of `ifgen bag`, which read their options and leave the work to a module each."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

import click
from ifgen.command_kit import options
from ifgen.command_kit.options import Command
from ifgen.command_kit.tool import ToolGroup

from ifgen_tools import completion
from ifgen_tools.bag.options import (
    CheckOptions,
    ConvertOptions,
    CutOptions,
    InfoOptions,
    MigrateOptions,
    PlayOptions,
    RecordOptions,
)
from ifgen_tools.verbs import ManyCommand, ManyOption, takes

# Late imports: each verb loads what it needs.

_BAG: Final = click.argument("bag_path", metavar="BAG", type=click.Path(path_type=Path))
_UNLIMITED: Final = click.option(
    "--unlimited", is_flag=True, help="Read files that unpack to far more than their size, too."
)
_OUTPUT: Final = click.option(
    "-o", "--output", type=click.Path(path_type=Path), help="A new folder, or a .mcap or .db3 file."
)
_STORAGE: Final = click.option(
    "-s", "--storage", type=click.Choice(["mcap", "sqlite3"]), help="By the output's name, or mcap."
)
_COMPRESSION: Final = click.option(
    "--compression-format",
    type=click.Choice(["zstd", "lz4", ""]),
    default="",
    metavar="[zstd|lz4]",
    help="What to compress with.",
)
_MODE: Final = click.option(
    "--compression-mode",
    type=click.Choice(["none", "file", "message"], case_sensitive=False),
    default="none",
    help="Compress whole files, or each message.",
)
_QOS: Final = click.option(
    "--qos-profile-overrides-path",
    "qos_overrides",
    type=click.Path(path_type=Path),
    help="A YAML file with a QoS profile for each topic.",
)
_NO_KEYS: Final = click.option("--disable-keyboard-controls", is_flag=True, help="Listen to no keys.")
_many = partial(click.option, cls=ManyOption)


def _regex(_: click.Context, __: click.Parameter, text: str) -> re.Pattern[str] | None:
    try:
        return re.compile(text) if text else None
    except re.error as error:
        raise click.BadParameter(f"{text!r} is no regular expression: {error}") from None


def _positive(_: click.Context, __: click.Parameter, value: float | None) -> float | None:
    if value is not None and not 0 < value < float("inf"):
        raise click.BadParameter(f"{value} is not in the valid range (> 0.0)")
    return value


def _written(command: Command) -> Command:
    """The options that say where and how a bag is written."""
    return _OUTPUT(_STORAGE(_COMPRESSION(_MODE(command))))


def _chosen(command: Command) -> Command:
    """The options that choose topics and services, as `topics`, `regex` and others."""
    for decorate in reversed(
        (
            _many("--topics", metavar="TOPIC...", help="These topics."),
            _many("--services", metavar="SERVICE...", help="What is told about the calls of these services."),
            click.option(
                "-e", "--regex", callback=_regex, default="", help="Topics and services that contain this."
            ),
            click.option(
                "--exclude-regex", "-x", callback=_regex, default="", help="None that contain this."
            ),
            _many("--exclude-topics", metavar="TOPIC...", help="None of these topics."),
            _many("--exclude-services", metavar="SERVICE...", help="None of these services."),
        )
    ):
        command = decorate(command)
    return command


def _accepted(*names: str, **attributes: Any) -> Callable[[Command], Command]:
    """An option of `ros2 bag` that has no meaning here."""
    return click.option(
        *names, expose_value=False, help="Accepted, as in ROS; it changes nothing.", **attributes
    )


@click.group(cls=ToolGroup)
def bag() -> None:
    """Record messages, play them, and look at what was recorded."""


@bag.command(cls=ManyCommand, epilog="Example: `ifgen bag record -o drive /imu /scan` until Ctrl-C.")
@click.argument("names", metavar="[TOPIC]...", nargs=-1, shell_complete=completion.topics)
@_OUTPUT
@click.option("-s", "--storage", type=click.Choice(["mcap", "sqlite3"]), help="mcap is the default.")
@_chosen
@_many("--topic-types", metavar="TYPE...", help="All topics of these types.")
@_many("--exclude-topic-types", metavar="TYPE...", help="No topics of these types.")
@click.option("-a", "--all", "everything", is_flag=True, help="All topics and services but hidden ones.")
@click.option("--all-topics", is_flag=True, help="All topics but hidden ones.")
@click.option("--all-services", is_flag=True, help="All services that tell about their calls.")
@click.option(
    "--include-unpublished-topics", is_flag=True, help="Topics that only have subscriptions as well."
)
@click.option("--include-hidden-topics", is_flag=True, help="Hidden topics as well.")
@click.option("--no-discovery", is_flag=True, help="Only the topics that are there at the start.")
@click.option(
    "-p",
    "--polling-interval",
    type=click.IntRange(min=1),
    default=100,
    metavar="MS",
    help="How often to look for topics.",
    show_default=True,
)
@click.option("--ignore-leaf-topics", is_flag=True, help="No topics without a subscription.")
@_QOS
@click.option(
    "-b",
    "--max-bag-size",
    type=click.IntRange(min=0),
    default=0,
    metavar="BYTES",
    help="Begin a new file after this number of bytes.",
)
@click.option(
    "-d",
    "--max-bag-duration",
    type=click.FloatRange(min=0),
    default=0,
    metavar="SECONDS",
    help="Begin a new file after so long.",
)
@click.option(
    "--max-bag-files",
    type=click.IntRange(min=0),
    default=0,
    help="Keep this number of files, and delete the oldest.",
)
@_MODE
@_COMPRESSION
@click.option(
    "--storage-preset-profile",
    "preset",
    type=click.Choice(["none", "fastwrite", "zstd_fast", "zstd_small", "resilient"]),
    default="none",
    help="Compress the chunks of an MCAP file (zstd_fast, zstd_small).",
)
@click.option(
    "--max-cache-size",
    type=click.IntRange(min=0),
    default=100 * 2**20,
    metavar="BYTES",
    help="What a snapshot holds at most.",
)
@click.option(
    "--max-waiting-size",
    type=click.IntRange(min=0),
    default=2**30,
    metavar="BYTES",
    help="What may wait in memory for a slow disk. What comes then is left out, and counted.",
)
@click.option("--snapshot-mode", is_flag=True, help="Write only when the service ~/snapshot is called.")
@click.option("--start-paused", is_flag=True, help="Wait for SPACE, or for the service ~/resume.")
@click.option("--use-sim-time", is_flag=True, help="Take the times from the topic /clock.")
@click.option(
    "--node-name", default="rosbag2_recorder", show_default=True, help="The name of the recorder's node."
)
@_many("--custom-data", metavar="KEY=VALUE...", help="Write these into the metadata.")
@_NO_KEYS
@_accepted("-f", "--serialization-format")
@_accepted("--storage-config-file")
@_accepted("--log-level")
@_accepted("--max-cache-duration", type=int)
@_accepted("--compression-queue-size", type=int)
@_accepted("--compression-threads", type=int)
@_accepted("--compression-threads-priority", type=int)
@options.transport_option
@takes(RecordOptions)
def record(chosen: RecordOptions) -> int:
    """Record topics until Ctrl-C. Topics that appear later are recorded as well."""
    from ifgen_tools.bag.record import record as run

    return run(chosen)


@bag.command(cls=ManyCommand, epilog="Example: `ifgen bag play drive --rate 2 --clock` at twice the speed.")
@_BAG
@_UNLIMITED
@_chosen
@click.option("-r", "--rate", type=float, default=1.0, callback=_positive, help="Play faster or slower.")
@click.option("-l", "--loop", is_flag=True, help="Begin again at the end, for ever.")
@_many("-m", "--remap", metavar="OLD:=NEW...", help="Publish on other topics.")
@click.option(
    "--clock",
    type=float,
    is_flag=False,
    flag_value=40.0,
    callback=_positive,
    metavar="[HZ]",
    help="Publish /clock, 40 times a second if no rate is given.",
)
@_many("--clock-topics", metavar="TOPIC...", help="Publish /clock before each message of these.")
@click.option("--clock-topics-all", is_flag=True, help="Publish /clock before each message.")
@click.option(
    "--start-offset",
    type=click.FloatRange(min=0),
    default=0.0,
    metavar="SECONDS",
    help="Leave out the beginning.",
)
@click.option("--playback-duration", type=float, metavar="SECONDS", help="Play only so much of it.")
@click.option(
    "--playback-until-sec", type=float, metavar="SECONDS", help="Play up to this time of the recording."
)
@click.option("--playback-until-nsec", type=int, metavar="NS", help="The same in nanoseconds.")
@click.option(
    "-d",
    "--delay",
    type=click.FloatRange(min=0),
    default=0.0,
    metavar="SECONDS",
    help="Wait before each start.",
)
@click.option("-p", "--start-paused", is_flag=True, help="Wait for SPACE, or for the service ~/resume.")
@_QOS
@click.option(
    "--wait-for-all-acked",
    type=float,
    default=0.0,
    metavar="MS",
    help="Wait at the end until everybody has everything; a negative time is for ever.",
)
@click.option(
    "--publish-service-requests",
    is_flag=True,
    help="Call services with the requests that were recorded, instead of publishing their events.",
)
@click.option(
    "--service-requests-source",
    type=click.Choice(["service_introspection", "client_introspection"]),
    default="service_introspection",
    metavar="SOURCE",
    help="Whose events have the requests: service_introspection (the default) or client_introspection.",
)
@_NO_KEYS
@_accepted("-s", "--storage")
@_accepted("--read-ahead-queue-size", type=int)
@_accepted("--storage-config-file")
@_accepted("--disable-loan-message", is_flag=True)
@_accepted("--log-level")
@options.transport_option
@takes(PlayOptions)
def play(chosen: PlayOptions) -> int:
    """Publish what was recorded, at the pace at which it was.

    SPACE pauses, the right arrow publishes the next message, up and down change the rate. Others can do the
    same by the services of /rosbag2_player.
    """
    from ifgen_tools.bag.play import play as run

    return run(chosen)


@bag.command(epilog="Example: `ifgen bag info drive` shows its topics, and how many messages they have.")
@_BAG
@_UNLIMITED
@click.option("-t", "--topic-name", is_flag=True, help="Only the names of topics.")
@click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="The hashes of types as well, and the requests and responses of services.",
)
@options.json_option
@_accepted("-s", "--storage")
@takes(InfoOptions)
def info(chosen: InfoOptions) -> int:
    """Print what is in a bag."""
    from ifgen_tools.bag.info import info as run

    return run(chosen)


@bag.command(epilog="Example: `ifgen bag convert drive -o drive.mcap` makes one file of a folder.")
@_BAG
@_UNLIMITED
@_written
@click.option(
    "-b", "--max-bag-size", type=int, default=0, metavar="BYTES", help="Begin a new file after these."
)
@takes(ConvertOptions)
def convert(chosen: ConvertOptions) -> int:
    """Write a bag in another format: MCAP or SQLite, a folder or a file, compressed or not."""
    from ifgen_tools.bag.files import convert as run

    return run(chosen)


@bag.command(cls=ManyCommand, epilog="Example: `ifgen bag cut drive -o turn.mcap --start 2 --end 5`.")
@_BAG
@_UNLIMITED
@_written
@_chosen
@click.option(
    "--start", default="", metavar="TIME", help="Seconds from the start, from the end (-3), or @UNIX."
)
@click.option("--end", default="", metavar="TIME", help="The same; what is received then is left out.")
@takes(CutOptions)
def cut(chosen: CutOptions) -> int:
    """Write a part of a bag: a range of time, or some topics. Messages stay as they are."""
    from ifgen_tools.bag.files import cut as run

    return run(chosen)


@bag.command(epilog="Example: `ifgen bag check drive` reads all of it, and compares its definitions.")
@_BAG
@_UNLIMITED
@options.json_option
@options.transport_option
@takes(CheckOptions)
def check(chosen: CheckOptions) -> int:
    """Say whether a bag is whole, and which of its types are defined otherwise here."""
    from ifgen_tools.bag.check import check as run
    from ifgen_tools.session import activate

    activate(chosen.transport)
    return run(chosen)


@bag.command(epilog="Example: `ifgen bag migrate drive --check` says what would be lost.")
@_BAG
@_UNLIMITED
@_written
@click.option(
    "--to",
    "reference",
    default="",
    metavar="REF",
    help="The definitions of a git revision, a folder or a lock file, in place of those installed.",
)
@click.option(
    "--adapters", default="", metavar="MODULE", help="The package of adapters (default: that of the project)."
)
@click.option("--check", is_flag=True, help="Write nothing, and say what would be lost.")
@click.option("--lossy", is_flag=True, help="Accept that fields are lost, or get their defaults.")
@options.transport_option
@takes(MigrateOptions)
def migrate(chosen: MigrateOptions) -> int:
    """Write a bag with the definitions of today.

    Messages are converted by your adapters (`ifgen adapt`), else field by field where no value can be lost.
    """
    from ifgen_tools.bag.migrate import migrate as run
    from ifgen_tools.session import activate

    activate(chosen.transport)
    return run(chosen)
