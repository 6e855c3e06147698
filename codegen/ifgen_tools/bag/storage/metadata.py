"""`metadata.yaml`, which tells what is in the files of a bag: as rosbag2 of Jazzy writes it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import yaml
from ifgen_runtime.bag.qos import write_qos
from ifgen_runtime.bag.topics import Channel

NAME: Final = "metadata.yaml"
_VERSION: Final = 9
_DISTRO: Final = "jazzy"


@dataclass(slots=True)
class FileFacts:
    """A file, with its times [ns] and the messages of each topic in it."""

    path: str
    start: int | None = None
    end: int = 0
    counts: Counter[tuple[str, str, str]] = field(default_factory=Counter[tuple[str, str, str]])

    def note(self, channel: Channel, received: int) -> None:
        """Count a message."""
        if self.start is None or received < self.start:
            self.start = received
        self.end = max(self.end, received)
        self.counts[key(channel)] += 1


def key(channel: Channel) -> tuple[str, str, str]:
    """What tells the channels of a bag apart."""
    return channel.topic, channel.definition.type_name, channel.definition.type_hash


def text(
    storage: str,
    files: Sequence[FileFacts],
    channels: Sequence[Channel],
    custom_data: Mapping[str, str] | None = None,
    compression: tuple[str, str] = ("", ""),
) -> str:
    """The text about files; `compression` is that of whole files or messages: its format and its mode."""
    starts = [file.start for file in files if file.start is not None]
    counts: Counter[tuple[str, str, str]] = sum((file.counts for file in files), Counter())
    information = {
        "version": _VERSION,
        "storage_identifier": storage,
        **_span(min(starts, default=0), max((file.end for file in files), default=0)),
        "message_count": counts.total(),
        "topics_with_message_count": [
            {"topic_metadata": _topic(channel), "message_count": counts[key(channel)]} for channel in channels
        ],
        "compression_format": compression[0],
        "compression_mode": compression[1],
        "relative_file_paths": [file.path for file in files],
        "files": [_file(file) for file in files],
        "custom_data": dict(custom_data) if custom_data else None,
        "ros_distro": _DISTRO,
    }
    document = {"rosbag2_bagfile_information": information}
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=10**6)


def _span(start: int, end: int) -> dict[str, Any]:
    return {
        "duration": {"nanoseconds": max(end - start, 0)},
        "starting_time": {"nanoseconds_since_epoch": start},
    }


def _topic(channel: Channel) -> dict[str, Any]:
    return {
        "name": channel.topic,
        "type": channel.definition.type_name,
        "serialization_format": channel.encoding,
        "offered_qos_profiles": yaml.safe_load(write_qos(channel.qos)) or [],
        "type_description_hash": channel.definition.type_hash,
    }


def _file(file: FileFacts) -> dict[str, Any]:
    span = _span(file.start or 0, file.end)
    return {
        "path": file.path,
        "starting_time": span["starting_time"],
        "duration": span["duration"],
        "message_count": file.counts.total(),
    }
