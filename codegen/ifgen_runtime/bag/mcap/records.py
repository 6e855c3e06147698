"""The records of MCAP (mcap.dev/spec) as values, and checksums. No length in a file is trusted.

Numbers are little endian. A record is an opcode, the length of its content, and the content.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from struct import Struct
from typing import Any, Final, TypeAlias
from zlib import crc32 as crc32_of_zlib

from ifgen_runtime.codec.choice import chosen

MAGIC: Final = b"\x89MCAP0\r\n"
HEAD: Final = Struct("<BQ")
MESSAGE: Final = Struct("<BQHIQQ")
"""The head of a message's record, its channel, sequence number, log time and publish time; data follows."""
FOOTER: Final = Struct("<QQI")


class Opcode(IntEnum):
    """The kinds of records."""

    HEADER = 1
    FOOTER = 2
    SCHEMA = 3
    CHANNEL = 4
    MESSAGE = 5
    CHUNK = 6
    MESSAGE_INDEX = 7
    CHUNK_INDEX = 8
    ATTACHMENT = 9
    ATTACHMENT_INDEX = 10
    STATISTICS = 11
    METADATA = 12
    METADATA_INDEX = 13
    SUMMARY_OFFSET = 14
    DATA_END = 15


class BadRecord(Exception):
    """A record is not what the format says. It never leaves this package."""


class Fields:
    """The fields of a record's content, one after the other."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self.position = 0
        """The bytes that were read so far."""

    def number(self, size: int) -> int:
        """An unsigned integer of `size` bytes."""
        return int.from_bytes(self.octets(size), "little")

    def octets(self, size: int) -> bytes:
        """The next `size` bytes."""
        end = self.position + size
        if end > len(self._content):
            raise BadRecord("a field reaches beyond the end of its record")
        found = self._content[self.position : end]
        self.position = end
        return found

    def text(self) -> str:
        """A string; bytes that are not UTF-8 are replaced."""
        return self.octets(self.number(4)).decode("utf-8", "replace")

    def texts(self) -> dict[str, str]:
        """A map of strings."""
        inside = Fields(self.octets(self.number(4)))
        found: dict[str, str] = {}
        while not inside.is_done:
            key = inside.text()
            found[key] = inside.text()
        return found

    def numbers(self, key: int, value: int) -> dict[int, int]:
        """A map of integers of these sizes."""
        inside = Fields(self.octets(self.number(4)))
        found: dict[int, int] = {}
        while not inside.is_done:
            number = inside.number(key)
            found[number] = inside.number(value)
        return found

    @property
    def is_done(self) -> bool:
        """Whether nothing is left."""
        return self.position >= len(self._content)


@dataclass(frozen=True, slots=True)
class SchemaRecord:
    """The definition of a type."""

    id: int
    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class ChannelRecord:
    """A topic, and what its messages are."""

    id: int
    schema: int
    topic: str
    encoding: str
    metadata: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class ChunkHead:
    """The head of a chunk; its records follow at `data`, `data_size` bytes of the file."""

    start: int
    end: int
    size: int
    crc: int
    compression: str
    data: int
    data_size: int


@dataclass(frozen=True, slots=True)
class ChunkIndex:
    """A chunk by the summary: its times, and where it and the indexes of its messages are."""

    start: int
    end: int
    offset: int
    length: int
    channels: frozenset[int]
    indexes_length: int


@dataclass(frozen=True, slots=True)
class Statistics:
    """Counts and times by the summary."""

    messages: int
    chunks: int
    start: int
    end: int
    by_channel: Mapping[int, int]


def schema(content: bytes) -> SchemaRecord:
    """Read a schema."""
    fields = Fields(content)
    number = fields.number(2)
    if not number:
        raise BadRecord("a schema has the number 0")
    return SchemaRecord(number, fields.text(), fields.text(), fields.octets(fields.number(4)))


def channel(content: bytes) -> ChannelRecord:
    """Read a channel."""
    fields = Fields(content)
    return ChannelRecord(fields.number(2), fields.number(2), fields.text(), fields.text(), fields.texts())


def chunk(content: bytes, offset: int, length: int) -> ChunkHead:
    """Read the head of a chunk's content, which is at this offset of the file and has this length."""
    fields = Fields(content)
    start, end, size, crc = fields.number(8), fields.number(8), fields.number(8), fields.number(4)
    compression = fields.text()
    data_size = fields.number(8)
    before = 8 + 8 + 8 + 4 + 4 + len(compression.encode()) + 8
    if before + data_size > length:
        raise BadRecord("the data of a chunk reaches beyond its end")
    return ChunkHead(start, end, size, crc, compression, offset + before, data_size)


def chunk_index(content: bytes) -> ChunkIndex:
    """Read the index entry of a chunk."""
    fields = Fields(content)
    start, end, offset, length = (fields.number(8) for _ in range(4))
    channels = fields.numbers(2, 8)
    return ChunkIndex(start, end, offset, length, frozenset(channels), fields.number(8))


def attachment(content: bytes) -> tuple[str, int, int]:
    """Read an attachment: its name, its checksum (0 if it has none), and how many bytes that is of."""
    fields = Fields(content)
    fields.octets(16)
    name, _ = fields.text(), fields.text()
    fields.octets(fields.number(8))
    covered = fields.position
    return name, fields.number(4), covered


def statistics(content: bytes) -> Statistics:
    """Read the statistics."""
    fields = Fields(content)
    messages, _, _, _, _, chunks = (fields.number(size) for size in (8, 2, 4, 4, 4, 4))
    return Statistics(messages, chunks, fields.number(8), fields.number(8), fields.numbers(2, 8))


Checksum: TypeAlias = Callable[[Any, int], int]


def crc32(data: bytes | bytearray | memoryview, before: int = 0) -> int:
    """The checksum of data that follows data whose checksum is `before`."""
    return _fastest()(data, before)


@cache
def _fastest() -> Checksum:
    """That of the extension, which has none for processors without the instruction."""
    found: Checksum = getattr(chosen().extension, "crc32", crc32_of_zlib)
    return found
