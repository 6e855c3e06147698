"""The `metadata.yaml` of a folder, as rosbag2 of Jazzy writes it and `ros2 bag` and rosbags read it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.bag.qos import parsed, write_qos
from ifgen_runtime.bag.topics import Channel

METADATA: Final = "metadata.yaml"
_VERSION: Final = 9
"""That of ROS 2 Jazzy: profiles are lists, and topics have hashes."""


@dataclass(slots=True)
class FileFacts:
    """A file, with its times [ns] and the messages of each channel in it."""

    path: str
    start: int | None = None
    end: int = 0
    counts: Counter[Channel] = field(default_factory=Counter[Channel])


def metadata_text(
    files: Sequence[FileFacts],
    channels: Sequence[Channel],
    *,
    storage: str,
    ros_distro: str,
    custom_data: Mapping[str, str] | None = None,
    compression: tuple[str, str] = ("", ""),
) -> str:
    """The text about files; `compression` is that of whole files or messages: its format and its mode."""
    import yaml  # takes long to load, and single files do without

    starts = [file.start for file in files if file.start is not None]
    counts: Counter[Channel] = sum((file.counts for file in files), Counter[Channel]())
    information = {
        "version": _VERSION,
        "storage_identifier": storage,
        **_span(min(starts, default=0), max((file.end for file in files), default=0)),
        "message_count": counts.total(),
        "topics_with_message_count": [
            {"topic_metadata": _topic(channel), "message_count": counts[channel]} for channel in channels
        ],
        "compression_format": compression[0],
        "compression_mode": compression[1],
        "relative_file_paths": [file.path for file in files],
        "files": [_file(file) for file in files],
        "custom_data": dict(custom_data) if custom_data else None,
        "ros_distro": ros_distro,
    }
    document = {"rosbag2_bagfile_information": information}
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=10**6)


def write_metadata(folder: Path, text: str) -> None:
    """Write the metadata of a folder, all of it or nothing. Raises BagError."""
    path = folder / METADATA
    temporary = path.with_name(f"{path.name}.new")
    try:
        temporary.write_text(text, "utf-8")
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise BagError(f"{path}: cannot be written: {error.strerror}") from error


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
        "offered_qos_profiles": parsed(write_qos(channel.qos)) or [],
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
