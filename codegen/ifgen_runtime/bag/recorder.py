"""Recording messages: `Recorder`."""

from __future__ import annotations

import shutil
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from threading import Lock
from types import TracebackType
from typing import Any, Final, Literal, Self, TypeAlias

from ifgen_runtime.bag.definitions import definition_of
from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.bag.metadata import METADATA
from ifgen_runtime.bag.qos import OfferedQoS, all_offered
from ifgen_runtime.bag.topics import Channel, Definition, Recorded, Topic
from ifgen_runtime.bag.writer import BagWriter, Format, Limits, storage_of
from ifgen_runtime.codec import serialize

Compression: TypeAlias = Literal["zstd", "lz4", "none"]

_Key: TypeAlias = tuple[str, Definition]
_CHUNK: Final = 2**20


class Recorder:
    """Records messages into a `.mcap` or `.db3` file, or into a folder as `ros2 bag record` makes it.

    The name decides: what ends in `.mcap` or `.db3` is a file, anything else a folder. Use it in a `with`
    statement. A chunk is on disk when it has `chunk_size` bytes (4 MB in `.db3` files), or at the first
    message a second after it was begun, so a crash loses no more than the last one.

    In a folder, a new file begins when one has `split_size` bytes, or when its messages were received over
    `split_duration` [s]. `overwrite` replaces what is at the path. `metadata` are the entries of a record of
    MCAP of the name `ifgen`.

    Raises BagError, here or when something is written: the path exists, a library is missing, the disk is
    full. What was written until then can be read.
    """

    def __init__(  # noqa: PLR0913 - a keyword for each choice
        self,
        path: str | PathLike[str],
        *,
        compression: Compression = "zstd",
        chunk_size: int = _CHUNK,
        split_size: int | None = None,
        split_duration: float | None = None,
        overwrite: bool = False,
        metadata: Mapping[str, str] | None = None,
        ros_distro: str = "",
    ) -> None:
        self.path = Path(path)
        """The file or folder."""
        storage = storage_of(self.path)
        self._is_folder = storage is None
        if not self._is_folder and (split_size or split_duration):
            raise BagError(_one_file(self.path))
        if storage == "sqlite3" and metadata:
            raise BagError(f"{self.path}: only an MCAP file has room for metadata=")
        self._lock = Lock()
        self._channels: dict[_Key, Channel] = {}
        self._counts: Counter[_Key] = Counter()
        self._known: dict[tuple[str, type[Any]], _Key] = {}
        self._last: dict[str, _Key] = {}
        _make_room(self.path, overwrite)
        self._writer = BagWriter(
            self.path,
            Format(storage or "mcap", "" if storage == "sqlite3" else compression, chunk_size=chunk_size),
            self._is_folder,
            Limits(duration=split_duration or 0.0, file_size=split_size or 0),
            ros_distro=ros_distro,
            records={"ifgen": metadata} if metadata else {},
        )

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics so far, with what was recorded of each."""
        return tuple(
            Topic(channel.topic, (channel.definition,), channel.qos, self._counts[key])
            for key, channel in self._channels.items()
        )

    @property
    def files(self) -> tuple[Path, ...]:
        """The files so far."""
        return self._writer.files

    def __len__(self) -> int:
        """The messages so far."""
        return self._counts.total()

    def __bool__(self) -> bool:
        return True

    def add_topic(self, topic: str, of: type[Any] | Definition | Topic, qos: Any = ()) -> None:
        """Add a topic, with its message class, or what a `Bag` says about it.

        `qos` is an rclpy `QoSProfile`, an `OfferedQoS`, or several. Messages add their topics by themselves;
        this is for profiles, for topics without messages, and for `write_serialized`.
        """
        offers = all_offered(qos)
        definitions = of.definitions if isinstance(of, Topic) else (self._definition(topic, of),)
        if isinstance(of, Topic):
            offers = offers or of.qos
        with self._lock:
            for definition in definitions:
                self._add(topic, definition, offers)

    def write(
        self, topic: str, message: Any, received: int | None = None, published: int | None = None
    ) -> None:
        """Record a message. The times are [ns since 1970]: now, and when it was received, if not given.

        Raises SerializationError for a message that cannot be serialised, BagError for one of another type
        than the topic has, and if nothing more can be written.
        """
        key = self._known.get((topic, message.__class__))
        if key is None:
            key = self._know(topic, message.__class__)
        data = serialize(message)
        with self._lock:
            self._write(key, data, received, published)

    def write_serialized(
        self, topic: str, data: bytes, received: int | None = None, published: int | None = None
    ) -> None:
        """Record a message of a topic that was added, in its serialised form."""
        key = self._last.get(topic)
        if key is None:
            raise BagError(f"{self.path}: {topic} has no type yet: call add_topic first")
        with self._lock:
            self._write(key, data, received, published)

    def write_recorded(
        self, recorded: Recorded, topic: str | None = None, qos: Iterable[OfferedQoS] | None = None
    ) -> None:
        """Copy a message of a `Bag` with its times and its definition, under its topic or another."""
        name = topic or recorded.topic
        key = (name, recorded.definition)
        with self._lock:
            if key not in self._channels:
                self._add(name, recorded.definition, tuple(recorded.qos if qos is None else qos))
            self._write(key, recorded.data, recorded.received, recorded.published)

    def flush(self) -> None:
        """Bring all that was recorded so far to the disk."""
        with self._lock:
            self._writer.flush()

    def split(self) -> None:
        """Begin a new file, if this is a folder."""
        if not self._is_folder:
            raise BagError(_one_file(self.path))
        with self._lock:
            self._writer.split()

    def close(self) -> None:
        """Complete the recording. Raises BagError if there is no room for that; what is there can be read."""
        with self._lock:
            self._writer.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except BagError:
            if error is None:
                raise

    def _know(self, topic: str, cls: type[Any]) -> _Key:
        """Note what the messages of a class on a topic are."""
        definition = self._definition(topic, cls)
        with self._lock:
            known = self._last.get(topic)
            if known is not None and known[1].type_name != definition.type_name:
                text = (
                    f"{topic} has messages of {known[1].type_name}, and this is one of {definition.type_name}"
                )
                raise BagError(f"{self.path}: {text}")
            key = (topic, definition)
            if key not in self._channels:
                self._add(topic, definition, ())
            self._known[topic, cls] = key
        return key

    def _definition(self, topic: str, of: type[Any] | Definition) -> Definition:
        if isinstance(of, Definition):
            return of
        try:
            return definition_of(of)
        except (AttributeError, TypeError, ValueError):
            name = getattr(of, "__name__", repr(of))
            raise BagError(f"{self.path}: {name} is no message class, and {topic} needs one") from None

    def _add(self, topic: str, definition: Definition, qos: tuple[OfferedQoS, ...]) -> None:
        key = (topic, definition)
        self._last[topic] = key
        if key not in self._channels:
            channel = self._channels[key] = Channel(topic, definition, qos)
            self._writer.add(channel)

    def _write(self, key: _Key, data: bytes, received: int | None, published: int | None) -> None:
        if received is None:
            received = time.time_ns()
        self._writer.write(self._channels[key], received, received if published is None else published, data)
        self._counts[key] += 1


def _one_file(path: Path) -> str:
    return f"{path}: only a folder can have several files: leave the ending {path.suffix} out"


def _make_room(path: Path, overwrite: bool) -> None:
    if not path.exists() and not path.is_symlink():
        return
    if not overwrite:
        raise BagError(f"{path} exists already: choose another name, or overwrite it")
    try:
        if path.is_dir() and not path.is_symlink():
            if not (path / METADATA).exists() and any(path.iterdir()):
                raise BagError(f"{path} is no bag, so it is not overwritten: it has no {METADATA}")
            shutil.rmtree(path)
        else:
            path.unlink()
    except OSError as error:
        raise BagError(f"{path}: cannot be overwritten: {error.strerror}") from error
