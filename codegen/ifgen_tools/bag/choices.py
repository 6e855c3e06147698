"""The choices of users on the command line, as the commands want them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from ifgen_tools.bag.selection import selection

if TYPE_CHECKING:
    from ifgen_runtime.bag.writer import Format

    from ifgen_tools.bag.playing.play import PlayOptions
    from ifgen_tools.bag.recording.record import RecordCommand
    from ifgen_tools.bag.selection import Selection

# Late imports: a verb loads what is its own.

_S: Final = 10**9
_PRESETS: Final = {"zstd_fast": "zstd", "zstd_small": "zstd"}
_SMALL: Final = 2**22


def record_command(**chosen: Any) -> RecordCommand:
    """The choices of `bag record`. Raises click.UsageError."""
    from ifgen_runtime.bag.writer import Limits

    from ifgen_tools.bag.recording.record import RecordCommand

    topics = (*chosen["names"], *chosen["topics"])
    every = chosen["everything"]
    named = (*topics, *chosen["services"], *chosen["topic_types"])
    if not (named or every or chosen["all_topics"] or chosen["all_services"] or chosen["regex"]):
        raise click.UsageError(
            "Nothing to record: name topics, or use -a, --all-topics, --all-services, --services, "
            "--topic-types or --regex."
        )
    if chosen["max_bag_files"] and not (chosen["max_bag_size"] or chosen["max_bag_duration"]):
        raise click.UsageError("--max-bag-files needs --max-bag-size or --max-bag-duration.")
    choice = selection(
        topics=topics,
        services=chosen["services"],
        types=chosen["topic_types"],
        regex=chosen["regex"],
        exclude_topics=chosen["exclude_topics"],
        exclude_services=chosen["exclude_services"],
        exclude_types=chosen["exclude_topic_types"],
        exclude_regex=chosen["exclude_regex"],
        all_topics=every or chosen["all_topics"],
        all_services=every or chosen["all_services"],
        include_hidden=chosen["include_hidden_topics"],
    )
    return RecordCommand(
        choice,
        chosen["output"],
        file_format(
            storage=chosen["storage"],
            output=chosen["output"],
            preset=chosen["preset"],
            mode=chosen["compression_mode"].lower(),
            compression=chosen["compression_format"],
        ),
        Limits(chosen["max_bag_size"], chosen["max_bag_duration"], chosen["max_bag_files"]),
        chosen["qos_overrides"],
        chosen["include_unpublished_topics"],
        chosen["ignore_leaf_topics"],
        not chosen["no_discovery"],
        chosen["polling_interval"] / 1000,
        chosen["use_sim_time"],
        chosen["start_paused"],
        chosen["max_cache_size"] if chosen["snapshot_mode"] else 0,
        dict(map(_pair, chosen["custom_data"])),
        not chosen["disable_keyboard_controls"],
        chosen["node_name"],
        chosen["max_waiting_size"],
    )


def play_options(**chosen: Any) -> PlayOptions:
    """The choices of `bag play`. Raises click.UsageError."""
    from ifgen_tools.bag.playing.play import PlayOptions

    choice = playable(chosen)
    for rule in chosen["remap"]:
        if not all(rule.partition(":=")):
            raise click.BadParameter(f"{rule!r} is no remapping, such as /old:=/new", param_hint="--remap")
    return PlayOptions(
        choice,
        chosen["rate"],
        chosen["loop"],
        chosen["start_offset"],
        _length(chosen["playback_duration"]),
        _until(chosen["playback_until_sec"], chosen["playback_until_nsec"]),
        chosen["delay"],
        chosen["start_paused"],
        chosen["clock"] or 0.0,
        frozenset() if chosen["clock_topics_all"] else frozenset(chosen["clock_topics"]) or None,
        chosen["remap"],
        chosen["qos_overrides"],
        not chosen["disable_keyboard_controls"],
        chosen["unlimited"],
        _request_events(chosen["publish_service_requests"], chosen["service_requests_source"]),
        chosen["wait_for_all_acked"] / 1000,
    )


def playable(chosen: dict[str, Any]) -> Selection:
    """The topics of a bag that are chosen: all, if none is named."""
    named = bool(chosen["topics"] or chosen["services"] or chosen["regex"])
    return selection(
        topics=chosen["topics"],
        services=chosen["services"],
        regex=chosen["regex"],
        exclude_topics=chosen["exclude_topics"],
        exclude_services=chosen["exclude_services"],
        exclude_regex=chosen["exclude_regex"],
        all_topics=not named,
        all_services=not named,
        include_hidden=True,
    )


def file_format(
    *,
    storage: str | None,
    output: Path | None,
    preset: str = "none",
    mode: str = "none",
    compression: str = "",
) -> Format:
    """The format of files, by the name of the output if nothing else says it. Raises click.UsageError."""
    from ifgen_runtime.bag.errors import BagError
    from ifgen_runtime.bag.writer import Format, storage_of

    try:
        by_name = storage_of(output) if output else None
    except BagError as error:
        raise click.UsageError(f"{error}.") from None
    if storage and by_name and storage != by_name:
        raise click.UsageError(f"{output} is the name of a {by_name} file, and --storage is {storage}.")
    storage = storage or by_name or "mcap"
    if mode != "none" and not compression:
        raise click.UsageError("--compression-mode needs --compression-format.")
    if mode == "none" and compression and storage == "sqlite3":
        raise click.UsageError("--compression-format needs --compression-mode file or message with sqlite3.")
    if mode != "none" and (compression != "zstd" or (storage == "mcap" and mode == "message")):
        raise click.UsageError(
            "files are compressed with zstd; messages only in sqlite3 files. "
            "In MCAP files, --compression-format alone compresses chunks."
        )
    chunks = _PRESETS.get(preset, "") or (compression if mode == "none" else "")
    if preset in _PRESETS and storage != "mcap":
        raise click.UsageError(f"--storage-preset-profile {preset} is one of mcap.")
    return Format(
        storage,
        chunks,
        mode if mode != "none" else "",
        _SMALL if preset == "zstd_small" else Format().chunk_size,
    )


def _pair(text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not (key and equals):
        raise click.BadParameter(f"{text!r} is no KEY=VALUE", param_hint="--custom-data")
    return key, value


def _request_events(wanted: bool, source: str) -> int | None:
    from ifgen_tools.bag.playing.requests import SOURCES

    return SOURCES[source] if wanted else None


def _length(seconds: float | None) -> float | None:
    """A duration; a negative one is none, as in ROS."""
    return None if seconds is None or seconds < 0 else seconds


def _until(seconds: float | None, nanoseconds: int | None) -> int | None:
    if seconds is not None and nanoseconds is not None:
        raise click.UsageError("--playback-until-sec and --playback-until-nsec exclude each other.")
    if nanoseconds is None:
        nanoseconds = None if seconds is None else round(seconds * _S)
    return None if nanoseconds is None or nanoseconds < 0 else nanoseconds
