"""Writes bags: a single file, or a folder of files with metadata.yaml that is split when a file is full."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Protocol, Self

from ifgen_runtime.bag.topics import Channel

from ifgen_tools.bag.storage import metadata
from ifgen_tools.bag.storage.metadata import FileFacts

SUFFIXES: Final = {"mcap": ".mcap", "sqlite3": ".db3"}
"""What the names of files end with, by the storage's name."""

_S: Final = 10**9


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
    """When the next file begins: after so many bytes or seconds; 0 is never. `files` are kept, 0 for all."""

    size: int = 0
    duration: float = 0.0
    files: int = 0


class FileWriter(Protocol):
    """A file that messages are added to."""

    def add(self, channel: Channel) -> object:
        """Add a channel, even if no message follows."""
        ...

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message."""
        ...

    def close(self, metadata: str = "") -> None:
        """Complete the file."""
        ...


@dataclass(slots=True)
class BagWriter:
    """A bag that is being written. `path` is a file, or a folder, by whether `is_folder`.

    `on_split` is told which file was closed and which was opened.
    """

    path: Path
    format: Format
    is_folder: bool = True
    limits: Limits = Limits()
    custom_data: Mapping[str, str] | None = None
    name: str = ""
    """What the files in a folder are called; the name of the folder, if it is empty."""
    on_split: Callable[[Path, Path], None] = lambda _, __: None
    _channels: dict[Channel, None] = field(default_factory=dict[Channel, None])
    _files: list[FileFacts] = field(default_factory=list[FileFacts])
    _writer: FileWriter | None = None
    _place: Path = Path()
    _size: int = 0
    _first: int = 0
    _number: int = 0

    def __post_init__(self) -> None:
        """Open the first file. Raises OSError and sqlite3.Error, as all methods do."""
        if self.is_folder:
            self.path.mkdir(parents=True)
        self._open()

    def add(self, channel: Channel) -> None:
        """Add a channel, even if no message follows."""
        if channel not in self._channels:
            self._channels[channel] = None
            assert self._writer is not None
            self._writer.add(channel)

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message that was received and published at these times [ns]."""
        if channel not in self._channels:
            self.add(channel)
        facts = self._files[-1]
        if facts.start is not None and self._is_full(received):
            self.split()
            facts = self._files[-1]
        if self.format.outer == "message":
            data = _compressed(data)
        facts.note(channel, received)
        self._size += len(data)
        assert self._writer is not None
        self._writer.write(channel, received, published, data)

    @property
    def count(self) -> int:
        """The messages in all files that are kept."""
        return sum(file.counts.total() for file in self._files)

    def split(self) -> None:
        """Go on in another file."""
        closed = self._close_file()
        self._open()
        self.on_split(closed, self._place)
        if self.limits.files and len(self._files) > self.limits.files:
            (self.path / self._files.pop(0).path).unlink(missing_ok=True)

    def close(self) -> None:
        """Complete the bag."""
        if self._writer is None:
            return
        self._close_file()
        if self.is_folder:
            (self.path / metadata.NAME).write_text(self._metadata(), encoding="utf-8")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _is_full(self, received: int) -> bool:
        limits = self.limits
        if limits.size and self._size >= limits.size:
            return True
        return bool(limits.duration) and received - (self._files[-1].start or 0) >= limits.duration * _S

    def _open(self) -> None:
        suffix = SUFFIXES[self.format.storage]
        name = f"{self.name or self.path.name}_{self._number}{suffix}"
        self._place = self.path / name if self.is_folder else self.path
        self._number, self._size = self._number + 1, 0
        self._writer = _opened(self._place, self.format)
        self._files.append(FileFacts(name if self.is_folder else self.name or self._place.name))
        for channel in self._channels:
            self._writer.add(channel)

    def _close_file(self) -> Path:
        assert self._writer is not None
        writer, self._writer = self._writer, None
        writer.close(self._metadata())
        if self.format.outer == "file":
            self._place = _compressed_file(self._place)
            self._files[-1].path = self._place.name
        return self._place

    def _metadata(self) -> str:
        outer = ("zstd", self.format.outer.upper()) if self.format.outer else ("", "")
        return metadata.text(self.format.storage, self._files, list(self._channels), self.custom_data, outer)


def _opened(path: Path, format: Format) -> FileWriter:
    if format.storage == "sqlite3":
        # A command writes one kind of file.
        from ifgen_tools.bag.storage.sqlite_writer import SqliteWriter

        return SqliteWriter(path)
    from ifgen_tools.bag.storage.mcap_writer import McapFileWriter  # the same

    return McapFileWriter(path, format.compression, format.chunk_size)


def _zstd() -> Any:
    from ifgen_runtime.bag.errors import need  # late, as what it looks for

    return need("zstandard", "compression")


def _compressed(data: bytes) -> bytes:
    return bytes(_zstd().ZstdCompressor(level=1).compress(data))


def _compressed_file(path: Path) -> Path:
    """Compress a file, and delete what it was."""
    target = path.with_name(f"{path.name}.zstd")
    with path.open("rb") as source, target.open("wb") as file:
        _zstd().ZstdCompressor(level=1).copy_stream(source, file, size=path.stat().st_size)
    path.unlink()
    return target
