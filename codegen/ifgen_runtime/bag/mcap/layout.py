"""Where the messages of an MCAP file are: by its summary, or by a walk through the whole file."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, Final

from ifgen_runtime.bag.compression import LARGEST, Undecodable, decompress
from ifgen_runtime.bag.errors import UNPACKS, BagError, Damages
from ifgen_runtime.bag.mcap import records
from ifgen_runtime.bag.mcap.records import (
    FOOTER,
    HEAD,
    MAGIC,
    BadRecord,
    ChannelRecord,
    ChunkHead,
    Opcode,
    SchemaRecord,
    Statistics,
    crc32,
)

_RUN: Final = 2**22
"""Bytes of messages outside chunks that are read at once."""

_RECORDS: Final = 300_000
"""Records in chunks that any file may have, when the whole file has to be searched."""

_HEAD_OF_CHUNK: Final = 256
"""Bytes that hold the head of a chunk's content, whatever its compression is called."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the file with messages: a chunk, or a run of records outside chunks."""

    start: int
    end: int
    offset: int
    length: int
    is_chunk: bool
    channels: frozenset[int] | None = None
    """The numbers of the channels in it; None if the file does not say."""


@dataclass(slots=True)
class Layout:
    """All that is known about a file before its messages are read."""

    schemas: dict[int, SchemaRecord] = field(default_factory=dict[int, SchemaRecord])
    channels: dict[int, ChannelRecord] = field(default_factory=dict[int, ChannelRecord])
    pieces: list[Piece] = field(default_factory=list[Piece])
    counts: Counter[int] = field(default_factory=Counter[int])
    attachments: list[tuple[int, int]] = field(default_factory=list[tuple[int, int]])
    """The offsets of attachments, and the lengths of their contents."""
    data_end: int = 0
    """The offset of the record that ends the data; 0 if it was not met."""

    @property
    def has_all_schemas(self) -> bool:
        """Whether the definition of each channel is known."""
        return {channel.schema for channel in self.channels.values()} - {0} <= self.schemas.keys()

    def note(self, opcode: int, content: bytes) -> None:
        """Note a schema or a channel; the first of a number counts."""
        if opcode == Opcode.SCHEMA:
            schema = records.schema(content)
            self.schemas.setdefault(schema.id, schema)
        elif opcode == Opcode.CHANNEL:
            channel = records.channel(content)
            self.channels.setdefault(channel.id, channel)


@dataclass(slots=True)
class OpenFile:
    """An MCAP file that is open, with its size when it was opened."""

    path: Path
    file: BinaryIO
    size: int
    damages: Damages
    _unpacked: int = 0
    _records: int = 0

    def read(self, offset: int, size: int) -> bytes:
        """Bytes of the file. Raises BadRecord if they are not all there."""
        if size > LARGEST:
            raise BadRecord(
                f"a record of {size:,} bytes is larger than the {LARGEST:,} that ifgen reads at once"
            )
        if offset < 0 or offset + size > self.size:
            raise BadRecord("a record reaches beyond the end of the file")
        try:
            self.file.seek(offset)
            found = self.file.read(size)
        except OSError as error:
            raise BadRecord(f"the file cannot be read: {error.strerror}") from None
        if len(found) < size:
            raise BadRecord("the file has become shorter")
        return found

    def head(self, offset: int) -> tuple[int, int]:
        """The opcode and the length of the content of the record at an offset."""
        opcode, length = HEAD.unpack(self.read(offset, HEAD.size))
        if offset + HEAD.size + length > self.size:
            raise BadRecord(f"a record of {length:,} bytes reaches beyond the end of the file")
        return opcode, length

    def chunk_head(self, offset: int, length: int) -> ChunkHead:
        """The head of the chunk whose content is at an offset."""
        return records.chunk(self.read(offset, min(length, _HEAD_OF_CHUNK)), offset, length)

    def chunk(self, head: ChunkHead) -> bytes:
        """The records in a chunk. Raises BadRecord if they are damaged, or too many for this file."""
        if LARGEST >= head.size > self.damages.most_unpacked(self.size):
            raise BadRecord(f"a chunk unpacks to {head.size:,} bytes, {UNPACKS}")
        try:
            found = decompress(head.compression, self.read(head.data, head.data_size), head.size)
        except Undecodable as error:
            raise BadRecord(str(error)) from None
        if head.crc and crc32(found) != head.crc:
            raise BadRecord("the checksum of a chunk does not fit its content")
        return found

    def records_of_chunk(self, position: int, length: int) -> Iterator[tuple[int, bytes, int]]:
        """The records in the chunk at this offset, while looking for what is in the file.

        Raises BadRecord if they are damaged, or if all chunks so far are too much for a file of this size.
        """
        head = self.chunk_head(position + HEAD.size, length)
        self._unpacked += head.size if head.size <= LARGEST else 0  # the next step refuses it
        most, most_records = self.damages.most_unpacked(self.size), _RECORDS + self.size // 4
        if self._unpacked > most:
            raise BadRecord(f"its chunks unpack to more than {most:,} bytes, {UNPACKS}")
        for record in records_in(self.chunk(head)):
            self._records += 1
            if self._records > most_records and not self.damages.unlimited:
                raise BadRecord(f"its chunks unpack to more than {most_records:,} records, {UNPACKS}")
            yield record


def layout_of(file: OpenFile) -> Layout:
    """The layout of a file: that of its summary, where this is sound, or what is found in it."""
    found = _layout_of(file)
    for channel in found.channels.values():
        if channel.schema and channel.schema not in found.schemas:
            text = f"the definition of the messages of {channel.topic} is not in the file"
            file.damages.note(file.path, None, text)
    return found


def _layout_of(file: OpenFile) -> Layout:
    if file.read(0, min(len(MAGIC), file.size)) != MAGIC:
        raise BagError(f"{file.path}: this is no MCAP file: it does not begin as one")
    reason = ""
    try:
        found = _by_summary(file)
        if found is not None:
            return found
    except BadRecord as error:
        reason = str(error)
    found, place = Layout(), 0
    try:
        for position in _walk(file, found):
            place = position
    except BadRecord as error:
        file.damages.note(file.path, place, f"{error}; {found.counts.total():,} messages are before it")
    else:
        if reason:
            file.damages.note(
                file.path, file.size, f"{reason}; {found.counts.total():,} messages are before it"
            )
    return found


def _by_summary(file: OpenFile) -> Layout | None:
    """The layout by the summary; None if the file has none, or not all that is needed."""
    tail = HEAD.size + FOOTER.size + len(MAGIC)
    if file.size < len(MAGIC) + tail or file.read(file.size - len(MAGIC), len(MAGIC)) != MAGIC:
        raise BadRecord(
            "the file was not completed, so it has no summary: it is cut off, or the recorder was killed"
        )
    at = file.size - tail
    opcode, length = file.head(at)
    if opcode != Opcode.FOOTER or length != FOOTER.size:
        raise BadRecord("the footer is not where it should be")
    start, _, crc = FOOTER.unpack(file.read(at + HEAD.size, FOOTER.size))
    if not start:
        return None
    if not len(MAGIC) <= start <= at:
        raise BadRecord("the summary is not where the footer says")
    summary = file.read(start, at - start)
    if crc and crc32(file.read(at, HEAD.size + 16), crc32(summary)) != crc:
        raise BadRecord("the checksum of the summary does not fit its content")
    return _summary(file, summary, start)


def _summary(file: OpenFile, summary: bytes, end: int) -> Layout | None:
    layout = Layout()
    chunks: list[records.ChunkIndex] = []
    said: Statistics | None = None
    for opcode, content, _ in records_in(summary):
        if opcode == Opcode.CHUNK_INDEX:
            chunks.append(records.chunk_index(content))
        elif opcode == Opcode.STATISTICS:
            said = records.statistics(content)
        else:
            layout.note(opcode, content)
    if said is None or len(chunks) != said.chunks or not layout.channels.keys() >= said.by_channel.keys():
        return None
    chunks.sort(key=lambda chunk: chunk.offset)
    position = len(MAGIC)
    for chunk in chunks:
        if chunk.offset < position or chunk.offset + chunk.length + chunk.indexes_length > end:
            raise BadRecord("the summary says that a chunk is where none can be")
        layout.pieces += _outside(file, position, chunk.offset, layout)
        channels = chunk.channels or None
        layout.pieces.append(Piece(chunk.start, chunk.end, chunk.offset, chunk.length, True, channels))
        position = chunk.offset + chunk.length + chunk.indexes_length
    layout.pieces += _outside(file, position, end, layout)
    layout.counts = Counter(said.by_channel)
    for piece in layout.pieces:  # where the summary does not repeat definitions
        if layout.has_all_schemas:
            break
        if piece.is_chunk:
            _, length = file.head(piece.offset)
            for opcode, content, _ in file.records_of_chunk(piece.offset, length):
                if opcode == Opcode.SCHEMA:
                    layout.note(opcode, content)
    return layout


def records_in(data: bytes) -> Iterator[tuple[int, bytes, int]]:
    """The opcodes, contents and offsets of records. Raises BadRecord where one reaches beyond the end."""
    position = 0
    while position < len(data):
        if position + HEAD.size > len(data):
            raise BadRecord("the head of a record reaches beyond the end")
        opcode, length = HEAD.unpack_from(data, position)
        end = position + HEAD.size + length
        if end > len(data):
            raise BadRecord("a record reaches beyond the end")
        yield opcode, data[position + HEAD.size : end], position
        position = end


def _outside(file: OpenFile, position: int, end: int, layout: Layout, count: bool = False) -> Iterator[Piece]:
    """The runs of messages between two offsets; what is no message is skipped, schemas and channels noted."""
    first = position
    times: list[int] = []
    while position < end:
        opcode, length = file.head(position)
        after = position + HEAD.size + length
        if opcode == Opcode.MESSAGE:
            fields = records.MESSAGE.unpack(file.read(position, records.MESSAGE.size))
            times.append(fields[4])
            if count:
                layout.counts[fields[2]] += 1
        else:
            _note(file, opcode, position, length, layout)
        if opcode in (Opcode.DATA_END, Opcode.FOOTER):
            after = end
        if times and (opcode != Opcode.MESSAGE or after - first > _RUN or after >= end):
            stop = after if opcode == Opcode.MESSAGE else position
            yield Piece(min(times), max(times), first, stop - first, False)
            first, times = after, list[int]()
        if not times:
            first = after
        position = after


def _note(file: OpenFile, opcode: int, position: int, length: int, layout: Layout) -> None:
    """Note a record outside chunks that is no message."""
    if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
        layout.note(opcode, file.read(position + HEAD.size, length))
    elif opcode == Opcode.ATTACHMENT:
        layout.attachments.append((position + HEAD.size, length))
    elif opcode == Opcode.DATA_END:
        layout.data_end = position


def wrong_checksums(file: OpenFile, layout: Layout) -> Iterator[tuple[int, str]]:
    """The checksums that do not fit what they are of, except those of chunks: where, and which."""
    for offset, length in layout.attachments:
        content = file.read(offset, length)
        name, crc, covered = records.attachment(content)
        if crc and crc32(content[:covered]) != crc:
            yield offset - HEAD.size, f"the checksum of the attachment {name!r} does not fit its content"
    if not layout.data_end:
        return
    crc, found, position = int.from_bytes(file.read(layout.data_end + HEAD.size, 4), "little"), 0, 0
    while crc and position < layout.data_end:
        size = min(_RUN, layout.data_end - position)
        found = crc32(file.read(position, size), found)
        position += size
    if crc and found != crc:
        yield layout.data_end, "the checksum of the data does not fit: a message may not be what was recorded"


def _walk(file: OpenFile, layout: Layout) -> Iterator[int]:
    """Fill the layout in. Yields the offset of each record before it is read, up to the end or to damage."""
    position = len(MAGIC)
    yield position
    while position < file.size:
        if file.size - position == len(MAGIC) and file.read(position, len(MAGIC)) == MAGIC:
            return
        opcode, length = file.head(position)
        after = position + HEAD.size + length
        if opcode == Opcode.CHUNK:
            _walk_chunk(file, position, length, layout)
        elif opcode == Opcode.MESSAGE:
            after = _run_end(file, position)
            layout.pieces += _outside(file, position, after, layout, count=True)
        else:
            _note(file, opcode, position, length, layout)
        if opcode in (Opcode.DATA_END, Opcode.FOOTER):
            return
        position = after
        yield position


def _run_end(file: OpenFile, position: int) -> int:
    """The end of a run of messages; of the sound ones, if there are others."""
    begin = position
    while position < file.size and position - begin < _RUN:
        try:
            opcode, length = file.head(position)
            if opcode != Opcode.MESSAGE or length < records.MESSAGE.size - HEAD.size:
                break
        except BadRecord:
            break
        position += HEAD.size + length
    if position == begin:
        raise BadRecord("a message is shorter than it can be")
    return position


def _walk_chunk(file: OpenFile, position: int, length: int, layout: Layout) -> None:
    times: list[int] = []
    channels: Counter[int] = Counter()
    for opcode, content, _ in file.records_of_chunk(position, length):
        if opcode == Opcode.MESSAGE:
            if len(content) < records.MESSAGE.size - HEAD.size:
                raise BadRecord("a message is shorter than it can be")
            channels[int.from_bytes(content[:2], "little")] += 1
            times.append(int.from_bytes(content[6:14], "little"))
        else:
            layout.note(opcode, content)
    layout.counts += channels
    if times:
        whole = HEAD.size + length
        piece = Piece(min(times), max(times), position, whole, True, frozenset(channels))
        layout.pieces.append(piece)


def opened(path: Path, damages: Damages) -> OpenFile:
    """Open a file for reading. Raises BagError if that fails."""
    try:
        file = path.open("rb")
        return OpenFile(path, file, os.fstat(file.fileno()).st_size, damages)
    except OSError as error:
        raise BagError(f"{path}: cannot be opened: {error.strerror}") from None
