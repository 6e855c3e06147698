"""The `metadata.yaml` of a folder, as `ros2 bag` and rosbags read it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.bag.qos import parsed, write_qos
from ifgen_runtime.bag.topics import Topic

_VERSION: Final = 9
"""That of ROS 2 Jazzy: profiles are lists, and topics have hashes."""


@dataclass(frozen=True, slots=True)
class FileFacts:
    """A file of the folder, complete."""

    name: str
    start: int | None
    end: int
    count: int


def write_metadata(path: Path, files: Sequence[FileFacts], topics: Sequence[Topic], distro: str = "") -> None:
    """Write the metadata of these files, all of it or nothing. Raises BagError."""
    import yaml  # takes long to load, and files do without

    starts = [file.start for file in files if file.start is not None]
    start, end = min(starts, default=0), max((file.end for file in files), default=0)
    about = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "duration": {"nanoseconds": end - start},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": sum(file.count for file in files),
        "topics_with_message_count": [_topic(topic) for topic in topics],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [_file(file) for file in files],
        "custom_data": None,
        "ros_distro": distro,
    }
    text = yaml.safe_dump({"rosbag2_bagfile_information": about}, sort_keys=False, allow_unicode=True)
    temporary = path.with_name(f"{path.name}.new")
    try:
        temporary.write_text(text, "utf-8")
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise BagError(f"{path}: cannot be written: {error.strerror}") from error


def _file(file: FileFacts) -> dict[str, Any]:
    start = file.start or 0
    return {
        "path": file.name,
        "starting_time": {"nanoseconds_since_epoch": start},
        "duration": {"nanoseconds": file.end - start if file.count else 0},
        "message_count": file.count,
    }


def _topic(topic: Topic) -> dict[str, Any]:
    about: dict[str, Any] = {
        "name": topic.name,
        "type": topic.type_name,
        "serialization_format": topic.encoding,
        "offered_qos_profiles": parsed(write_qos(topic.qos)) or [],
        "type_description_hash": topic.type_hash,
    }
    return {"topic_metadata": about, "message_count": topic.count}
