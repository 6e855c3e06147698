"""The files of a recording: one, or those of a folder as `ros2 bag record` makes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, cast

from ifgen_runtime.bag.compression import decompressed_file
from ifgen_runtime.bag.errors import BagError, Damages
from ifgen_runtime.bag.mcap.file import McapFile
from ifgen_runtime.bag.metadata import METADATA
from ifgen_runtime.bag.qos import OfferedQoS, parsed, profiles_of
from ifgen_runtime.bag.topics import Source

_ENDINGS: Final = (".mcap", ".db3")
_ZSTD: Final = (".zstd", ".zst")


@dataclass(slots=True)
class Recording:
    """The files of a recording, and what its metadata says."""

    sources: list[Source] = field(default_factory=list[Source])
    compression: str = ""
    """The compression of each message by itself, in `.db3` files."""
    qos: dict[str, tuple[OfferedQoS, ...]] = field(default_factory=dict[str, "tuple[OfferedQoS, ...]"])
    hashes: dict[str, str] = field(default_factory=dict[str, str])
    """Type hashes by topic, by the metadata."""
    files: list[Path] = field(default_factory=list[Path])
    """The files as they are called, also where what is read is a decompressed copy."""
    ros_distro: str = ""
    temporary: list[Path] = field(default_factory=list[Path])

    def close(self) -> None:
        """Close all files, and remove temporary ones."""
        for source in self.sources:
            source.close()
        while self.temporary:
            self.temporary.pop().unlink(missing_ok=True)


def opened(path: Path, damages: Damages) -> Recording:
    """Open a file or a folder. Raises BagError."""
    recording = Recording()
    try:
        if path.is_dir():
            _open_folder(path, recording, damages)
        elif path.is_file():
            recording.sources.append(_file(path, recording, damages))
        elif path.exists():
            text = f"{path}: this is no bag: it is {_kind(path)}, and a file or a folder was expected"
            raise BagError(text)
        else:
            raise BagError(f"{path}: there is no such file or folder")
    except OSError as error:
        recording.close()
        raise BagError(f"{path}: cannot be read: {error.strerror}") from None
    except BaseException:
        recording.close()
        raise
    return recording


def _kind(path: Path) -> str:
    """The kind of a path that is neither a file nor a folder, in words."""
    kinds = {"a pipe": path.is_fifo(), "a socket": path.is_socket()}
    return next((kind for kind, is_this in kinds.items() if is_this), "a device")


def _open_folder(path: Path, recording: Recording, damages: Damages) -> None:
    metadata = _metadata(path / METADATA, damages)
    files = _named_files(path, metadata, damages) or _found_files(path)
    if not files:
        raise BagError(f"{path}: this is no bag: there is no .mcap and no .db3 file in the folder")
    if str(metadata.get("compression_mode")).upper() == "MESSAGE":
        recording.compression = str(metadata.get("compression_format", ""))
    recording.ros_distro = str(metadata.get("ros_distro") or "")
    for name, about in _topics(metadata):
        recording.hashes[name] = str(about.get("type_description_hash") or "")
        recording.qos[name] = profiles_of(about.get("offered_qos_profiles"))
    for file in files:
        try:
            recording.sources.append(_file(file, recording, damages))
        except BagError as error:
            if damages.strict or len(files) == 1:
                raise
            damages.note(file, None, f"the file is left out: {error}")


def _metadata(path: Path, damages: Damages) -> dict[str, Any]:
    """The contents of `metadata.yaml`. After a crash there is none, and the files are all."""
    if not path.is_file():
        return {}
    try:
        loaded = parsed(path.read_text("utf-8"))
    except ValueError as error:
        first = str(error).partition("\n")[0]
        damages.note(path, None, f"{first}. The files of the folder are read without it")
        return {}
    root = cast("dict[str, object]", loaded) if isinstance(loaded, dict) else {}
    about = root.get("rosbag2_bagfile_information")
    return cast("dict[str, Any]", about) if isinstance(about, dict) else {}


def _topics(metadata: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    found: list[tuple[str, dict[str, Any]]] = []
    listed: object = metadata.get("topics_with_message_count")
    for item in cast("list[object]", listed) if isinstance(listed, list) else []:
        about = cast("dict[str, object]", item).get("topic_metadata") if isinstance(item, dict) else None
        if isinstance(about, dict):
            topic = cast("dict[str, Any]", about)
            found.append((str(topic.get("name")), topic))
    return found


def _named_files(path: Path, metadata: dict[str, Any], damages: Damages) -> list[Path]:
    """The files that the metadata names, which have to be in the folder."""
    files: list[Path] = []
    root = path.resolve()
    listed: object = metadata.get("relative_file_paths")
    for name in dict.fromkeys(map(str, cast("list[object]", listed))) if isinstance(listed, list) else {}:
        file = path / name
        if not file.is_file():  # before ROS 2 Foxy, names began with the folder
            file = path / Path(name).name
        if not file.is_file():
            damages.note(path / METADATA, None, f"there is no file {name!r}, which it names")
        elif not file.resolve().is_relative_to(root):
            damages.note(path / METADATA, None, f"{name!r} is outside the folder, and is left out")
        else:
            files.append(file)
    return files


def _found_files(path: Path) -> list[Path]:
    """The files in a folder that can be read, in the order of their numbers: bag_2 comes before bag_10."""
    endings = (*_ENDINGS, *(ending + more for ending in _ENDINGS for more in _ZSTD))
    found = (file for file in path.iterdir() if file.name.endswith(endings) and file.is_file())
    return sorted(found, key=_number)


def _number(path: Path) -> tuple[int, str]:
    number = path.name.partition(".")[0].rpartition("_")[2]
    return int(number) if number.isascii() and number.isdigit() else 0, path.name


def _file(path: Path, recording: Recording, damages: Damages) -> Source:
    recording.files.append(path)
    if path.suffix in _ZSTD:
        path = decompressed_file(path, damages)
        recording.temporary.append(path)
    with path.open("rb") as file:
        beginning = file.read(16)
    if beginning.startswith(b"SQLite format 3") or path.suffix == ".db3":
        from ifgen_runtime.bag.sqlite.file import SqliteFile  # with sqlite3, which MCAP does not need

        source = SqliteFile(path, damages, recording.hashes)
        if source.has_compressed_messages:  # after a crash there is no metadata that says so
            recording.compression = recording.compression or "zstd"
        return source
    if beginning.startswith(b"\x89MCAP") or path.suffix == ".mcap":
        return McapFile(path, damages, recording.hashes)
    if beginning.startswith(b"#ROSBAG"):
        text = "a bag of ROS 1. `rosbags-convert` of the library rosbags turns it into one of ROS 2"
        raise BagError(f"{path}: this is {text}")
    raise BagError(f"{path}: this is no bag: a .mcap or .db3 file, or a folder with them, was expected")
