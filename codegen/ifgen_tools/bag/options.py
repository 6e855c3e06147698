"""The options of the verbs of `ifgen bag`, and the topics that they choose, as `ros2 bag` chooses them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ifgen_tools.types import message_name
from ifgen_tools.verbs import SessionOptions

if TYPE_CHECKING:
    from ifgen_runtime.bag.writer import Format, Limits

# Late imports: most verbs write no bag.

SERVICE_EVENTS = "/_service_event"
"""The end of the topic on which the calls of a service are told."""

_S: Final = 10**9
_PRESETS: Final = {"zstd_fast": "zstd", "zstd_small": "zstd"}
_SMALL: Final = 2**22  # bytes of a chunk
_SOURCES: Final = {"client_introspection": 0, "service_introspection": 1}
"""The kinds of events that have requests, of service_msgs/msg/ServiceEventInfo."""


def is_service_event(topic: str) -> bool:
    """Whether a topic tells of the calls of a service."""
    return topic.endswith(SERVICE_EVENTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """The choice of topics and services, with names as users write them.

    `regex` chooses besides what is named, and each `exclude...` takes away from all of that. With
    `all_topics` or `all_services`, the names do not matter.
    """

    topics: Sequence[str] = ()
    services: Sequence[str] = ()
    types: Sequence[str] = ()
    regex: re.Pattern[str] | None = None
    all_topics: bool = False
    all_services: bool = False
    include_hidden: bool = False
    exclude_topics: Sequence[str] = ()
    exclude_services: Sequence[str] = ()
    exclude_types: Sequence[str] = ()
    exclude_regex: re.Pattern[str] | None = None

    def takes(self, topic: str, type_name: str) -> bool:
        """Whether a topic is chosen."""
        from ifgen_tools.ros_graph import is_hidden  # half of the time that `--help` takes

        name = topic.removesuffix(SERVICE_EVENTS)
        if self.exclude_regex is not None and self.exclude_regex.search(name):
            return False
        matches = self.regex is not None and self.regex.search(name) is not None
        if is_service_event(topic):
            is_excluded = _is_among(name, self.exclude_services)
            return not is_excluded and (self.all_services or _is_among(name, self.services) or matches)
        if _is_among(topic, self.exclude_topics) or type_name in map(message_name, self.exclude_types):
            return False
        if _is_among(topic, self.topics):
            return True
        if is_hidden(topic) and not self.include_hidden:
            return False
        return self.all_topics or matches or type_name in map(message_name, self.types)


def _is_among(name: str, names: Sequence[str]) -> bool:
    """True if a full name is among those that a user wrote, perhaps without the `/` in front."""
    return any(name == (each if each.startswith("/") else f"/{each}") for each in names)


@dataclass(frozen=True, kw_only=True)
class BagOptions:
    """The options of a verb that reads a bag, with `unlimited` one that unpacks to far more than its size."""

    bag_path: Path
    unlimited: bool = False


@dataclass(frozen=True, kw_only=True)
class TopicOptions:
    """The options that choose topics, and services by what is told about their calls."""

    topics: tuple[str, ...] = ()
    services: tuple[str, ...] = ()
    regex: re.Pattern[str] | None = None
    exclude_topics: tuple[str, ...] = ()
    exclude_services: tuple[str, ...] = ()
    exclude_regex: re.Pattern[str] | None = None

    def of_bag(self) -> Selection:
        """The choice of what a bag has: all if nothing is named."""
        is_open = not (self.topics or self.services or self.regex)
        return Selection(
            topics=self.topics,
            services=self.services,
            regex=self.regex,
            exclude_topics=self.exclude_topics,
            exclude_services=self.exclude_services,
            exclude_regex=self.exclude_regex,
            all_topics=is_open,
            all_services=is_open,
            include_hidden=True,
        )


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """The options of a verb that writes a bag."""

    output: Path | None = None
    storage: str | None = None
    compression_mode: str = "none"
    compression_format: str = ""
    preset: str = "none"

    def require_output(self) -> Path:
        """The place to write to. Raises click.UsageError."""
        if self.output is None:
            raise click.UsageError("Missing option '-o' / '--output'.")
        return self.output

    def file_format(self) -> Format:
        """The format of files, by the name of the output if nothing else says it. Raises click.UsageError."""
        from ifgen_runtime.bag.errors import BagError
        from ifgen_runtime.bag.writer import Format, storage_of

        mode, compression, preset = self.compression_mode.lower(), self.compression_format, self.preset
        try:
            by_name = storage_of(self.output) if self.output else None
        except BagError as error:
            raise click.UsageError(f"{error}.") from None
        if self.storage and by_name and self.storage != by_name:
            raise click.UsageError(
                f"{self.output} is the name of a {by_name} file, and --storage is {self.storage}."
            )
        storage = self.storage or by_name or "mcap"
        if mode != "none" and not compression:
            raise click.UsageError("--compression-mode needs --compression-format.")
        if mode == "none" and compression and storage == "sqlite3":
            raise click.UsageError(
                "--compression-format needs --compression-mode file or message with sqlite3."
            )
        if mode != "none" and (compression != "zstd" or (storage == "mcap" and mode == "message")):
            raise click.UsageError(
                "files are compressed with zstd; messages only in sqlite3 files. "
                "In MCAP files, --compression-format alone compresses chunks."
            )
        if preset in _PRESETS and storage != "mcap":
            raise click.UsageError(f"--storage-preset-profile {preset} is one of mcap.")
        chunks = _PRESETS.get(preset, "") or (compression if mode == "none" else "")
        size = _SMALL if preset == "zstd_small" else Format().chunk_size
        return Format(storage, chunks, mode if mode != "none" else "", size)


@dataclass(frozen=True, kw_only=True)
class RecordOptions(SessionOptions, TopicOptions, OutputOptions):
    """The options of `bag record`; the interval is in ms, sizes are in bytes, and the duration is in s."""

    names: tuple[str, ...] = ()
    topic_types: tuple[str, ...] = ()
    exclude_topic_types: tuple[str, ...] = ()
    everything: bool = False
    all_topics: bool = False
    all_services: bool = False
    include_unpublished_topics: bool = False
    include_hidden_topics: bool = False
    no_discovery: bool = False
    polling_interval: int = 100
    ignore_leaf_topics: bool = False
    qos_overrides: Path | None = None
    max_bag_size: int = 0
    max_bag_duration: float = 0
    max_bag_files: int = 0
    max_cache_size: int = 100 * 2**20
    max_waiting_size: int = 2**30
    snapshot_mode: bool = False
    start_paused: bool = False
    use_sim_time: bool = False
    node_name: str = "rosbag2_recorder"
    custom_data: tuple[str, ...] = ()
    disable_keyboard_controls: bool = False

    def selection(self) -> Selection:
        """The choice of topics. Raises click.UsageError if it is empty."""
        topics = (*self.names, *self.topics)
        named = (*topics, *self.services, *self.topic_types)
        if not (named or self.everything or self.all_topics or self.all_services or self.regex):
            raise click.UsageError(
                "Nothing to record: name topics, or use -a, --all-topics, --all-services, --services, "
                "--topic-types or --regex."
            )
        return Selection(
            topics=topics,
            services=self.services,
            types=self.topic_types,
            regex=self.regex,
            exclude_topics=self.exclude_topics,
            exclude_services=self.exclude_services,
            exclude_types=self.exclude_topic_types,
            exclude_regex=self.exclude_regex,
            all_topics=self.everything or self.all_topics,
            all_services=self.everything or self.all_services,
            include_hidden=self.include_hidden_topics,
        )

    def limits(self) -> Limits:
        """The limits of a file, and of their number. Raises click.UsageError."""
        from ifgen_runtime.bag.writer import Limits

        if self.max_bag_files and not (self.max_bag_size or self.max_bag_duration):
            raise click.UsageError("--max-bag-files needs --max-bag-size or --max-bag-duration.")
        return Limits(self.max_bag_size, self.max_bag_duration, self.max_bag_files)

    def metadata(self) -> dict[str, str]:
        """The entries of `custom_data`. Raises click.UsageError for one that is no KEY=VALUE."""
        entries: dict[str, str] = {}
        for text in self.custom_data:
            key, equals, value = text.partition("=")
            if not (key and equals):
                raise click.BadParameter(f"{text!r} is no KEY=VALUE", param_hint="--custom-data")
            entries[key] = value
        return entries


@dataclass(frozen=True, kw_only=True)
class PlayOptions(SessionOptions, BagOptions, TopicOptions):
    """The options of `bag play`; times are in s, unless their names say otherwise, and the clock in Hz."""

    rate: float = 1.0
    loop: bool = False
    remap: tuple[str, ...] = ()
    clock: float | None = None
    clock_topics: tuple[str, ...] = ()
    clock_topics_all: bool = False
    start_offset: float = 0.0
    playback_duration: float | None = None
    playback_until_sec: float | None = None
    playback_until_nsec: int | None = None
    delay: float = 0.0
    start_paused: bool = False
    qos_overrides: Path | None = None
    wait_for_all_acked: float = 0.0
    """The time [ms] to wait at the end until everybody has everything; negative for ever, 0 not at all."""
    publish_service_requests: bool = False
    service_requests_source: str = "service_introspection"
    disable_keyboard_controls: bool = False

    def check(self) -> None:
        """Raise click.UsageError for options that cannot be."""
        for rule in self.remap:
            if not all(rule.partition(":=")):
                raise click.BadParameter(
                    f"{rule!r} is no remapping, such as /old:=/new", param_hint="--remap"
                )
        if self.playback_until_sec is not None and self.playback_until_nsec is not None:
            raise click.UsageError("--playback-until-sec and --playback-until-nsec exclude each other.")

    @property
    def duration(self) -> int | None:
        """The duration [ns]; a negative one is none, as in ROS."""
        seconds = self.playback_duration
        return None if seconds is None or seconds < 0 else round(seconds * _S)

    @property
    def until(self) -> int | None:
        """The time of the recording [ns] at which to end; a negative one is none."""
        time = self.playback_until_nsec
        if time is None and self.playback_until_sec is not None:
            time = round(self.playback_until_sec * _S)
        return None if time is None or time < 0 else time

    @property
    def request_events(self) -> int | None:
        """The kind of service events whose requests are sent; None publishes the events."""
        return _SOURCES[self.service_requests_source] if self.publish_service_requests else None


@dataclass(frozen=True, kw_only=True)
class InfoOptions(BagOptions):
    """The options of `bag info`."""

    topic_name: bool
    verbose: bool
    as_json: bool


@dataclass(frozen=True, kw_only=True)
class CheckOptions(SessionOptions, BagOptions):
    """The options of `bag check`."""


@dataclass(frozen=True, kw_only=True)
class ConvertOptions(BagOptions, OutputOptions):
    """The options of `bag convert`."""

    max_bag_size: int


@dataclass(frozen=True, kw_only=True)
class CutOptions(BagOptions, TopicOptions, OutputOptions):
    """The options of `bag cut`."""

    start: str
    end: str


@dataclass(frozen=True, kw_only=True)
class MigrateOptions(SessionOptions, BagOptions, OutputOptions):
    """The options of `bag migrate`."""

    reference: str
    adapters: str
    check: bool
    lossy: bool
