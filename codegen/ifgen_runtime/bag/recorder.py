"""Recording messages: `Recorder`."""

from __future__ import annotations

import shutil
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from threading import Lock
from types import TracebackType
from typing import Any, Final, Literal, Self, TypeAlias

from ifgen_runtime.bag.definitions import full_text
from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.bag.folder import METADATA
from ifgen_runtime.bag.mcap_writer import McapWriter
from ifgen_runtime.bag.metadata import FileFacts, write_metadata
from ifgen_runtime.bag.qos import OfferedQoS, all_offered, write_qos
from ifgen_runtime.bag.topics import Definition, Recorded, Topic
from ifgen_runtime.codec import serialize
from ifgen_runtime.type_description import type_hash, type_name

Compression: TypeAlias = Literal["zstd", "lz4", "none"]

_Key: TypeAlias = tuple[str, Definition]
_CHUNK: Final = 2**20
_SECONDS: Final = 1.0


class Recorder:
    """Records messages into a `.mcap` file, or into a folder as `ros2 bag record` makes it.

    The name decides: what ends in `.mcap` is a file, anything else a folder. Use it in a `with` statement. A
    chunk is on disk when it has `chunk_size` bytes, or at the first message a second after it was begun, so a
    crash loses no more than the last one.

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
        self._is_folder = self.path.suffix != ".mcap"
        if not self._is_folder and (split_size or split_duration):
            raise BagError(f"{self.path}: only a folder can have several files: leave the ending .mcap out")
        self._compression, self._chunk_size = compression, chunk_size
        self._split_size = split_size or 2**64
        self._split_duration = round((split_duration or 2**32) * 1e9)
        self._metadata, self._distro = metadata, ros_distro
        self._lock = Lock()
        self._topics: dict[_Key, Topic] = {}
        self._counts: Counter[_Key] = Counter()
        self._channels: dict[_Key, int] = {}
        self._schemas: dict[Definition, int] = {}
        self._known: dict[tuple[str, type[Any]], _Key] = {}
        self._last: dict[str, _Key] = {}
        self._files: list[FileFacts] = []
        self._is_closed = False
        _make_room(self.path, overwrite)
        if self._is_folder:
            _make_folder(self.path)
        self._writer = self._open()

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The topics so far, with what was recorded of each."""
        return tuple(replace(topic, count=self._counts[key]) for key, topic in self._topics.items())

    @property
    def files(self) -> tuple[Path, ...]:
        """The files so far."""
        return (*(self.path / file.name for file in self._files), self._writer.path)

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
            raise BagError(f"{self.path}: only a folder can have several files: leave the ending .mcap out")
        with self._lock:
            self._split()

    def close(self) -> None:
        """Complete the recording. Raises BagError if there is no room for that; what is there can be read."""
        with self._lock:
            if self._is_closed:
                return
            self._is_closed = True
            try:
                self._close_file()
            finally:
                self._write_metadata()

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
            cls = _generated(of)
            return Definition(type_name(cls), type_hash(cls), "ros2msg", full_text(cls))
        except (AttributeError, TypeError, ValueError):
            name = getattr(of, "__name__", repr(of))
            raise BagError(f"{self.path}: {name} is no message class, and {topic} needs one") from None

    def _add(self, topic: str, definition: Definition, qos: tuple[OfferedQoS, ...]) -> None:
        key = (topic, definition)
        self._last[topic] = key
        if key not in self._channels:
            self._topics[key] = Topic(topic, (definition,), qos, 0)
            self._open_channel(key)

    def _open_channel(self, key: _Key) -> None:
        topic, definition = key
        schema = self._schemas.get(definition)
        if schema is None:
            encoding = definition.encoding or "ros2msg"
            schema = self._writer.add_schema(definition.type_name, encoding, definition.text)
            self._schemas[definition] = schema
        qos = write_qos(self._topics[key].qos)
        about = {"offered_qos_profiles": qos, "topic_type_hash": definition.type_hash}
        self._channels[key] = self._writer.add_channel(schema, topic, "cdr", about)

    def _write(self, key: _Key, data: bytes, received: int | None, published: int | None) -> None:
        if self._is_closed:
            raise BagError(f"{self.path}: the recording is complete: nothing more can be written")
        if received is None:
            received = time.time_ns()
        if self._is_full(received):
            self._split()
        writer = self._writer
        writer.write(self._channels[key], received, received if published is None else published, data)
        self._counts[key] += 1

    def _open(self) -> McapWriter:
        path = self.path
        if self._is_folder:
            path = path / f"{path.resolve().name}_{len(self._files)}.mcap"
        return McapWriter(path, self._compression, self._chunk_size, _SECONDS)

    def _is_full(self, received: int) -> bool:
        """Whether a message that is received then begins a new file."""
        begin = self._writer.begin
        too_long = begin is not None and received - begin >= self._split_duration
        return too_long or self._writer.size >= self._split_size

    def _split(self) -> None:
        self._close_file()
        self._writer = self._open()
        self._schemas.clear()
        for key in self._channels:
            self._open_channel(key)

    def _close_file(self) -> None:
        writer = self._writer
        try:
            if self._metadata:
                writer.add_metadata("ifgen", self._metadata)
        finally:
            try:
                writer.close()
            finally:
                facts = FileFacts(writer.path.name, writer.start, writer.end, writer.count)
                self._files.append(facts)

    def _write_metadata(self) -> None:
        if self._is_folder:
            write_metadata(self.path / METADATA, self._files, self.topics, self._distro)


def _generated(of: type[Any]) -> type[Any]:
    """The class as it was generated, for one with checks."""
    return next((cls for cls in of.__mro__ if "__type_hash__" in vars(cls)), of)


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


def _make_folder(path: Path) -> None:
    try:
        path.mkdir(parents=True)
    except OSError as error:
        raise BagError(f"{path}: the folder cannot be made: {error.strerror}") from error
