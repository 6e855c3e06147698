"""Writing an MCAP file: chunk after chunk, each complete on disk before the next is begun."""

from __future__ import annotations

import os
import time
from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from struct import pack
from sys import byteorder
from typing import Any, Final

from ifgen_runtime.bag.errors import BagError, need
from ifgen_runtime.bag.mcap.records import FOOTER, HEAD, MAGIC, MESSAGE, Opcode, crc32

_LIBRARY: Final = "ifgen"
_LONGEST_TIME: Final = 2**64
_MOST_CHANNELS: Final = 2**16
_PARTS: Final = 64
"""Pieces of memory that are written at once; systems have a limit."""

Compress = Callable[[Any], Any]


def compressor(compression: str) -> Compress | None:
    """The function that compresses a chunk; None for no compression. Raises BagError."""
    if compression in ("", "none"):
        return None
    if compression == "zstd":
        zstandard = need("zstandard", "recording with zstd")
        return zstandard.ZstdCompressor(level=1).compress  # type: ignore[no-any-return]
    if compression == "lz4":
        frame = need("lz4.frame", "recording with lz4")
        return frame.compress  # type: ignore[no-any-return]
    raise BagError(f"there is no compression {compression!r}: use zstd, lz4 or none")


@dataclass(slots=True)
class _Summary:
    """Records that the end of the file repeats."""

    schemas: bytearray = field(default_factory=bytearray)
    channels: bytearray = field(default_factory=bytearray)
    chunks: bytearray = field(default_factory=bytearray)
    metadata: bytearray = field(default_factory=bytearray)
    schema_count: int = 0
    chunk_count: int = 0
    metadata_count: int = 0
    counts: dict[int, int] = field(default_factory=dict[int, int])


@dataclass(slots=True)
class _Chunk:
    """The chunk that is being filled."""

    data: bytearray = field(default_factory=bytearray)
    indexes: dict[int, array[int]] = field(default_factory=dict[int, "array[int]"])
    start: int = _LONGEST_TIME
    end: int = 0
    begun: float = 0.0
    count: int = 0


class McapWriter:
    """An MCAP file that is being written, of the profile `ros2`.

    A chunk is written when it has `chunk_size` bytes, or when `seconds` have passed since it was begun.
    """

    def __init__(self, path: Path, compression: str, chunk_size: int, seconds: float) -> None:
        self.path = path
        self._compression = "" if compression == "none" else compression
        self._compress = compressor(compression)
        self._chunk_size, self._seconds = chunk_size, seconds
        self._summary, self._chunk = _Summary(), _Chunk()
        self.start: int | None = None
        """When the first message was received [ns]."""
        self.end = 0
        """When the last message was received [ns]."""
        try:
            self._file = os.open(
                path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666
            )
        except FileExistsError:
            raise BagError(f"{path} exists already") from None
        except OSError as error:
            raise BagError(f"{path}: cannot be written: {error.strerror}") from None
        self._position = 0
        self._failure = ""
        self._append(MAGIC, _record(Opcode.HEADER, _text("ros2"), _text(_LIBRARY)))

    @property
    def counts(self) -> Mapping[int, int]:
        """The messages of each channel in the file, without the chunk that is being filled."""
        return self._summary.counts

    @property
    def size(self) -> int:
        """Bytes in the file, and in the chunk that is being filled."""
        return self._position + len(self._chunk.data)

    def add_schema(self, name: str, encoding: str, text: str) -> int:
        """Add the definition of a type. Returns its number."""
        summary = self._summary
        if summary.schema_count + 1 >= _MOST_CHANNELS:
            raise BagError(f"{self.path}: an MCAP file has room for 65,535 definitions")
        summary.schema_count += 1
        content = (pack("<H", summary.schema_count), _text(name), _text(encoding), _text(text))
        record = _record(Opcode.SCHEMA, *content)
        self._chunk.data += record
        summary.schemas += record
        return summary.schema_count

    def add_channel(self, schema: int, topic: str, encoding: str, metadata: Mapping[str, str]) -> int:
        """Add a channel. Returns its number."""
        summary = self._summary
        number = len(summary.counts)
        if number >= _MOST_CHANNELS:
            raise BagError(f"{self.path}: an MCAP file has room for 65,536 channels")
        about = b"".join(_text(key) + _text(value) for key, value in metadata.items())
        content = (pack("<HH", number, schema), _text(topic), _text(encoding), pack("<I", len(about)), about)
        record = _record(Opcode.CHANNEL, *content)
        self._chunk.data += record
        summary.channels += record
        summary.counts[number] = 0
        return number

    def write(self, channel: int, received: int, published: int, data: bytes) -> None:
        """Add a message; `received` and `published` [ns] count from 0 to 2**64 - 1."""
        if self._failure:
            raise BagError(self._failure)
        if not (0 <= received < _LONGEST_TIME and 0 <= published < _LONGEST_TIME):
            raise BagError(f"{self.path}: a time of {received} or {published} ns cannot be recorded")
        chunk = self._chunk
        offset = len(chunk.data)
        chunk.data += MESSAGE.pack(Opcode.MESSAGE, 22 + len(data), channel, 0, received, published)
        chunk.data += data
        index = chunk.indexes.get(channel)
        if index is None:
            index = chunk.indexes[channel] = array("Q")
        index.append(received)
        index.append(offset)
        chunk.start, chunk.end = min(chunk.start, received), max(chunk.end, received)
        chunk.count += 1
        now = time.monotonic()
        if not chunk.begun:
            chunk.begun = now
        if offset + len(data) >= self._chunk_size or now - chunk.begun >= self._seconds:
            self.flush()

    def flush_old(self) -> None:
        """Write the chunk that is being filled, if it was begun long enough ago."""
        if self._chunk.begun and time.monotonic() - self._chunk.begun >= self._seconds:
            self.flush()

    def flush(self) -> None:
        """Write the chunk that is being filled, if there is anything in it."""
        chunk = self._chunk
        if not chunk.data:
            return
        self._chunk = _Chunk()
        start = min(chunk.start, chunk.end)
        compressed = self._compress(chunk.data) if self._compress else chunk.data
        compression = self._compression
        if len(compressed) >= len(chunk.data):
            compressed, compression = chunk.data, ""
        about = pack("<QQQI", start, chunk.end, len(chunk.data), crc32(chunk.data))
        about += _text(compression) + pack("<Q", len(compressed))
        head = HEAD.pack(Opcode.CHUNK, len(about) + len(compressed)) + about
        indexes: list[bytes] = []
        offsets = bytearray()
        at = self._position + len(head) + len(compressed)
        first = at
        for channel, index in chunk.indexes.items():
            if byteorder == "big":
                index.byteswap()
            entries = index.tobytes()
            indexes.append(_record(Opcode.MESSAGE_INDEX, pack("<HI", channel, len(entries)), entries))
            offsets += pack("<HQ", channel, at)
            at += len(indexes[-1])
        offset = self._position
        self._append(head, compressed, *indexes)
        for channel, index in chunk.indexes.items():
            self._summary.counts[channel] += len(index) // 2
        self._summary.chunk_count += 1
        self._summary.chunks += _record(
            Opcode.CHUNK_INDEX,
            pack("<QQQQI", start, chunk.end, offset, len(head) + len(compressed), len(offsets)),
            bytes(offsets),
            pack("<Q", at - first) + _text(compression) + pack("<QQ", len(compressed), len(chunk.data)),
        )
        if chunk.indexes:
            self.start = start if self.start is None else min(self.start, start)
            self.end = max(self.end, chunk.end)

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a record of metadata."""
        about = b"".join(_text(key) + _text(value) for key, value in values.items())
        record = _record(Opcode.METADATA, _text(name), pack("<I", len(about)), about)
        place = pack("<QQ", self._position, len(record))
        self._append(record)
        self._summary.metadata_count += 1
        self._summary.metadata += _record(Opcode.METADATA_INDEX, place, _text(name))

    def close(self) -> None:
        """Write what is left, and the summary. Raises BagError if there is no room for that."""
        try:
            if not self._failure:
                self.flush()
            self._append_summary()
        finally:
            os.close(self._file)

    def _append_summary(self) -> None:
        summary = self._summary
        data_end = _record(Opcode.DATA_END, bytes(4))
        start = self._position + len(data_end)
        counts = b"".join(pack("<HQ", channel, count) for channel, count in summary.counts.items())
        about = (summary.schema_count, len(summary.counts), 0, summary.metadata_count, summary.chunk_count)
        statistics = _record(
            Opcode.STATISTICS,
            pack("<QHIIII", sum(summary.counts.values()), *about),
            pack("<QQI", self.start or 0, self.end, len(counts)),
            counts,
        )
        groups: dict[Opcode, bytes | bytearray] = {
            Opcode.SCHEMA: summary.schemas,
            Opcode.CHANNEL: summary.channels,
            Opcode.STATISTICS: statistics,
            Opcode.CHUNK_INDEX: summary.chunks,
            Opcode.METADATA_INDEX: summary.metadata,
        }
        body, offsets = bytearray(), bytearray()
        for opcode, records in groups.items():
            if records:
                place = pack("<BQQ", opcode, start + len(body), len(records))
                offsets += _record(Opcode.SUMMARY_OFFSET, place)
                body += records
        after = start + len(body)
        body += offsets
        body += HEAD.pack(Opcode.FOOTER, FOOTER.size) + pack("<QQ", start, after)
        self._append(data_end, body, pack("<I", crc32(body)), MAGIC)

    def _append(self, *parts: Any) -> None:
        """Write all of this at the end, or nothing. Raises BagError."""
        waiting = [memoryview(part) for part in parts if len(part)]
        try:
            while waiting:
                written = _write(self._file, waiting)
                while waiting and written >= len(waiting[0]):
                    written -= len(waiting.pop(0))
                if written:
                    waiting[0] = waiting[0][written:]
        except OSError as error:
            os.ftruncate(self._file, self._position)
            os.lseek(self._file, self._position, os.SEEK_SET)
            self._fail(error)
        self._position += sum(map(len, parts))

    def _fail(self, error: OSError) -> None:
        """Remember that nothing more can be written. What is on disk ends with a whole record."""
        written = sum(self._summary.counts.values())
        text = f"{self.path}: cannot be written any further: {error.strerror}. It has {written:,} messages"
        self._failure = text
        raise BagError(text) from error


def _write(file: int, parts: list[memoryview]) -> int:
    """Write some of these parts, as many bytes as is returned."""
    if hasattr(os, "writev"):
        return os.writev(file, parts[:_PARTS])
    return os.write(file, parts[0])


def _record(opcode: Opcode, *content: Any) -> bytes:
    return b"".join((HEAD.pack(opcode, sum(map(len, content))), *content))


def _text(text: str) -> bytes:
    try:
        encoded = text.encode("utf-8", "surrogateescape")  # bytes that are no text, of another file
    except UnicodeEncodeError:
        encoded = text.encode("utf-8", "replace")
    return pack("<I", len(encoded)) + encoded
