"""Writing bags: a single file, or a folder of files with metadata.yaml that is split when a file is full."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Protocol, Self

from ifgen_runtime.bag.errors import BagError, need
from ifgen_runtime.bag.mcap.writer import McapWriter
from ifgen_runtime.bag.metadata import FileFacts, metadata_text, write_metadata
from ifgen_runtime.bag.qos import write_qos
from ifgen_runtime.bag.topics import Channel, Definition

SUFFIXES: Final = {"mcap": ".mcap", "sqlite3": ".db3"}
"""The ends of the names of files, by storage."""

_OTHERS: Final = {".bag", ".db", ".sqlite", ".sqlite3", ".zst", ".zstd", *SUFFIXES.values()}
"""Ends of the names of files, in small letters: nobody wants a folder of such a name."""

_SECONDS: Final = 1.0
"""How long a message waits at most for the next one before it is in the file."""

_S: Final = 10**9


def storage_of(path: Path) -> str | None:
    """The storage of the file with this name; None for the name of a folder.

    Raises BagError for the name of a file of another kind.
    """
    for storage, suffix in SUFFIXES.items():
        if path.suffix == suffix:
            return storage
    if path.suffix.lower() in _OTHERS:
        raise BagError(
            f"{path} is the name of a file, and ifgen writes none that ends in {path.suffix}: "
            "name a folder, or a file that ends in .mcap or .db3"
        )
    return None


@dataclass(frozen=True, slots=True)
class Format:
    """How files are written.

    `compression` is that of the chunks of an MCAP file: `zstd`, `lz4` or empty. `outer` is what rosbag2 does
    besides: `file` or `message` if whole files or each message are compressed with zstd.
    """

    storage: str = "mcap"
    compression: str = ""
    outer: str = ""
    chunk_size: int = 2**20


@dataclass(frozen=True, slots=True)
class Limits:
    """When the next file begins; 0 is never.

    After messages of `size` bytes, after `file_size` bytes in the file, or after `duration` [s]. `files` are
    kept, 0 for all.
    """

    size: int = 0
    duration: float = 0.0
    files: int = 0
    file_size: int = 0


class FileWriter(Protocol):
    """A file that messages are added to. All methods raise BagError."""

    path: Path

    @property
    def facts(self) -> FileFacts:
        """The messages that are in the file, without those that wait."""
        ...

    @property
    def size(self) -> int:
        """Bytes of the file, with those that wait."""
        ...

    def add(self, channel: Channel) -> None:
        """Add a channel, even if no message follows."""
        ...

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message of a channel that was added; the times are [ns]."""
        ...

    def flush(self) -> None:
        """Write what waits."""
        ...

    def flush_old(self) -> None:
        """Write what waits, if the first of it has waited for long enough."""
        ...

    def close(self, records: Mapping[str, Mapping[str, str]]) -> None:
        """Complete the file, with records of metadata by their names."""
        ...


class _McapFileWriter:
    """An MCAP file, with the definitions, channels and metadata of rosbag2's storage `mcap`."""

    def __init__(self, path: Path, compression: str, chunk_size: int) -> None:
        self.path = path
        self._writer = McapWriter(path, compression, chunk_size, _SECONDS)
        self._schemas: dict[Definition, int] = {}
        self._numbers: dict[Channel, int] = {}
        self.flush, self.flush_old = self._writer.flush, self._writer.flush_old

    @property
    def facts(self) -> FileFacts:
        writer = self._writer
        counts = Counter({channel: writer.counts[number] for channel, number in self._numbers.items()})
        return FileFacts(self.path.name, writer.start, writer.end, counts)

    @property
    def size(self) -> int:
        return self._writer.size

    def add(self, channel: Channel) -> None:
        if channel in self._numbers:
            return
        definition = channel.definition
        schema = self._schemas.get(definition)
        if not definition.type_name and not definition.text:
            schema = 0  # the way of MCAP to say that there is none
        if schema is None:
            encoding = definition.encoding or "ros2msg"
            schema = self._writer.add_schema(definition.type_name, encoding, definition.text)
            self._schemas[definition] = schema
        about = {"offered_qos_profiles": write_qos(channel.qos), "topic_type_hash": definition.type_hash}
        self._numbers[channel] = self._writer.add_channel(schema, channel.topic, channel.encoding, about)

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        self._writer.write(self._numbers[channel], received, published, data)

    def close(self, records: Mapping[str, Mapping[str, str]]) -> None:
        try:
            for name, values in records.items():
                self._writer.add_metadata(name, values)
        finally:
            self._writer.close()


@dataclass(slots=True)
class BagWriter:
    """A bag that is being written: `path` is a file, or a folder, by whether `is_folder`.

    In a folder, `metadata.yaml` is written at the end, also if something failed: it says what is there.
    Methods raise BagError. What was written before can be read.
    """

    path: Path
    format: Format
    is_folder: bool = True
    limits: Limits = Limits()
    custom_data: Mapping[str, str] | None = None
    name: str = ""
    """The name of the files in a folder; that of the folder, if it is empty."""
    on_split: Callable[[Path, Path], None] = lambda _, __: None
    """Is called with the file that was closed, and the one that was opened."""
    ros_distro: str = "jazzy"
    records: Mapping[str, Mapping[str, str]] | None = None
    """The records of metadata in each MCAP file, by their names; None for that of rosbag2."""
    _channels: dict[Channel, None] = field(default_factory=dict[Channel, None])
    _files: list[FileFacts] = field(default_factory=list[FileFacts])
    _writer: FileWriter | None = None
    _size: int = 0
    _first: int | None = None
    _count: int = 0
    _number: int = 0
    _is_closed: bool = False

    def __post_init__(self) -> None:
        """Open the first file."""
        if self.is_folder:
            try:
                self.path.mkdir(parents=True)
            except OSError as error:
                raise BagError(f"{self.path}: the folder cannot be made: {error.strerror}") from error
        self._open()

    @property
    def count(self) -> int:
        """The messages in all files that are kept, and those that wait."""
        return sum(file.counts.total() for file in self._files) + self._count

    @property
    def files(self) -> tuple[Path, ...]:
        """The files so far."""
        closed = [self.path / file.path if self.is_folder else self.path for file in self._files]
        return (*closed, *(() if self._writer is None else (self._writer.path,)))

    def add(self, channel: Channel) -> None:
        """Add a channel, even if no message follows."""
        if channel not in self._channels:
            self._channels[channel] = None
            self._open_file().add(channel)

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message that was received and published at these times [ns]."""
        writer = self._open_file()
        if channel not in self._channels:
            self.add(channel)
        if self._first is not None and self._is_full(writer, received):
            self.split()
            writer = self._open_file()
        if self.format.outer == "message":
            data = bytes(_zstd().compress(data))
        writer.write(channel, received, published, data)
        self._first = received if self._first is None else min(self._first, received)
        self._size += len(data)
        self._count += 1

    def flush(self) -> None:
        """Write what waits."""
        self._open_file().flush()

    def flush_old(self) -> None:
        """Write what waits, if the first of it has waited for a second: call it often."""
        self._open_file().flush_old()

    def split(self) -> None:
        """Go on in another file."""
        self._open_file()
        closed = self._close_file()
        self._open()
        self.on_split(closed, self._open_file().path)
        if self.limits.files and len(self._files) >= self.limits.files:
            (self.path / self._files.pop(0).path).unlink(missing_ok=True)

    def close(self) -> None:
        """Complete the bag."""
        if self._is_closed:
            return
        self._is_closed = True
        try:
            if self._writer is not None:
                self._close_file()
        except BagError:
            with suppress(BagError):  # the first failure is the one to report
                self._write_metadata()
            raise
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

    def _open_file(self) -> FileWriter:
        if self._writer is None:
            raise BagError(f"{self.path}: the recording is complete: nothing more can be written")
        return self._writer

    def _is_full(self, writer: FileWriter, received: int) -> bool:
        """Whether a message that is received then begins a new file."""
        limits = self.limits
        if (limits.size and self._size >= limits.size) or 0 < limits.file_size <= writer.size:
            return True
        return bool(limits.duration) and received - (self._first or 0) >= limits.duration * _S

    def _open(self) -> None:
        path = self.path
        if self.is_folder:
            path /= f"{self.name or path.resolve().name}_{self._number}{SUFFIXES[self.format.storage]}"
        self._number, self._size, self._count, self._first = self._number + 1, 0, 0, None
        self._writer = _opened(path, self.format)
        for channel in self._channels:
            self._writer.add(channel)

    def _close_file(self) -> Path:
        writer, self._writer, self._count = self._open_file(), None, 0
        try:
            writer.flush()
        finally:
            facts = writer.facts
            if not self.is_folder:
                facts.path = self.name or facts.path
            self._files.append(facts)
            text = {"serialized_metadata": self._metadata()} if self.records is None else {}
            writer.close({"rosbag2": text} if self.records is None else self.records)
        if self.format.outer != "file":
            return writer.path
        path = _compressed_file(writer.path)
        facts.path = path.name
        return path

    def _write_metadata(self) -> None:
        if self.is_folder:
            write_metadata(self.path, self._metadata())

    def _metadata(self) -> str:
        return metadata_text(
            self._files,
            list(self._channels),
            storage=self.format.storage,
            ros_distro=self.ros_distro,
            custom_data=self.custom_data,
            compression=("zstd", self.format.outer.upper()) if self.format.outer else ("", ""),
        )


def _opened(path: Path, format: Format) -> FileWriter:
    if format.storage == "sqlite3":
        from ifgen_runtime.bag.sqlite.writer import SqliteWriter  # with sqlite3, which MCAP does not need

        return SqliteWriter(path, _SECONDS)
    return _McapFileWriter(path, format.compression, format.chunk_size)


def _zstd() -> Any:
    # A database has no checksums of its own.
    return need("zstandard", "compression").ZstdCompressor(level=1, write_checksum=True)


def _compressed_file(path: Path) -> Path:
    """Compress a file, and delete what it was. If that fails, it stays as it was."""
    target = path.with_name(f"{path.name}.zstd")
    try:
        with path.open("rb") as source, target.open("wb") as file:
            _zstd().copy_stream(source, file, size=path.stat().st_size)
        path.unlink()
    except OSError as error:
        target.unlink(missing_ok=True)
        raise BagError(f"{target}: cannot be written: {error.strerror}") from error
    return target
