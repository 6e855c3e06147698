"""The messages of an MCAP file, in the order in which they were received."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from itertools import pairwise
from operator import itemgetter
from pathlib import Path

from ifgen_runtime.bag.definitions import type_in
from ifgen_runtime.bag.errors import BagError, Damages
from ifgen_runtime.bag.mcap.layout import Layout, OpenFile, Piece, layout_of, opened, wrong_checksums
from ifgen_runtime.bag.mcap.records import HEAD, MESSAGE, BadRecord, ChannelRecord, Opcode
from ifgen_runtime.bag.qos import read_qos
from ifgen_runtime.bag.topics import Batch, Channel, Definition, Entry, Wanted

_received = itemgetter(0)


class McapFile:
    """An MCAP file. It is a `Source`.

    `hashes` are type hashes by topic, for a file that has none.
    """

    def __init__(self, path: Path, damages: Damages, hashes: Mapping[str, str]) -> None:
        self._file: OpenFile = opened(path, damages)
        try:
            layout = layout_of(self._file)
        except BadRecord as error:
            self.close()
            raise BagError(f"{path}: {error}") from None
        except BagError:
            self.close()
            raise
        self._layout: Layout | None = layout
        self.attachments = len(layout.attachments)
        self._pieces = sorted(layout.pieces, key=lambda piece: (piece.start, piece.offset))
        self._by_number = {n: _channel(record, layout, hashes) for n, record in layout.channels.items()}
        self.channels = {channel: layout.counts[number] for number, channel in self._by_number.items()}
        self.start = min((piece.start for piece in self._pieces), default=None)
        self.end = max((piece.end for piece in self._pieces), default=None)

    def batches(self, wanted: Wanted) -> Iterator[Batch]:
        """The messages in the order in which they were received, a chunk at a time."""
        self._check()
        channels = {n: channel for n, channel in self._by_number.items() if wanted.has_topic(channel.topic)}
        pieces = [piece for piece in self._pieces if _may_have(piece, wanted, channels)]
        waiting: list[Entry] = []  # they may come after some of the next chunk
        for piece, following in pairwise((*pieces, None)):
            assert piece is not None  # only the last one is followed by None
            batch = self._batch(piece, channels, wanted)
            if not waiting and _is_ready(batch, following):
                if batch:
                    yield batch
                continue
            entries = sorted((*waiting, *batch), key=_received)
            ready = (
                len(entries) if following is None else bisect_left(entries, following.start, key=_received)
            )
            waiting = entries[ready:]
            if ready:
                yield Batch.of(entries[:ready])

    def _check(self) -> None:
        """Compare the checksums that are not those of chunks, once, before the first message is read."""
        file, layout, self._layout = self._file, self._layout, None
        if layout is None:
            return
        try:
            for offset, text in wrong_checksums(file, layout):
                file.damages.note(file.path, offset, text)
        except BadRecord as error:
            file.damages.note(file.path, None, str(error))

    def _batch(self, piece: Piece, channels: dict[int, Channel], wanted: Wanted) -> Batch:
        """The messages of a piece, up to damage in it."""
        file = self._file
        try:
            if piece.is_chunk:
                opcode, length = file.head(piece.offset)
                if opcode != Opcode.CHUNK:
                    raise BadRecord("there is no chunk where the summary says")
                data = file.chunk(file.chunk_head(piece.offset + HEAD.size, length))
            else:
                data = file.read(piece.offset, piece.length)
        except BadRecord as error:
            file.damages.note(file.path, piece.offset, f"{error}; the messages of this part are lost")
            return Batch()
        batch, unread = _messages_in(data, channels)
        if unread is not None:
            place = f"byte {unread:,} of a chunk's content" if piece.is_chunk else "a message"
            file.damages.note(file.path, piece.offset, f"{place} is not what the format says")
        if wanted.start is None and wanted.end is None:
            return batch
        return Batch.of(entry for entry in batch if wanted.has_time(entry[0]))

    def close(self) -> None:
        """Close the file."""
        self._file.file.close()


def _is_ready(batch: Batch, following: Piece | None) -> bool:
    """Whether messages are in order, and all of them come before those of the next chunk."""
    times = batch.received
    return times == sorted(times) and (not times or following is None or times[-1] < following.start)


def _may_have(piece: Piece, wanted: Wanted, channels: dict[int, Channel]) -> bool:
    if not wanted.overlaps(piece.start, piece.end):
        return False
    return piece.channels is None or not piece.channels.isdisjoint(channels)


def _messages_in(records: bytes, channels: dict[int, Channel]) -> tuple[Batch, int | None]:
    """The messages of these channels among records, and the offset of a record that is broken."""
    batch = Batch()
    add_received, add_published = batch.received.append, batch.published.append
    add_channel, add_data = batch.channels.append, batch.data.append
    unpack, of = MESSAGE.unpack_from, channels.get
    position, size = 0, len(records)
    last = size - MESSAGE.size
    while position <= last:
        opcode, length, number, _, received, published = unpack(records, position)
        after = position + 9 + length
        if after > size:
            return batch, position
        if opcode == 5:
            if length < 22:
                return batch, position
            channel = of(number)
            if channel is not None:
                add_received(received)
                add_published(published)
                add_channel(channel)
                add_data(records[position + 31 : after])
        position = after
    return batch, (None if _ends_well(records, position) else position)


def _ends_well(data: bytes, position: int) -> bool:
    """Whether only whole records follow that are too short for a message."""
    while position + HEAD.size <= len(data):
        opcode, length = HEAD.unpack_from(data, position)
        if opcode == Opcode.MESSAGE:
            return False
        position += HEAD.size + length
    return position == len(data)


def _channel(record: ChannelRecord, layout: Layout, hashes: Mapping[str, str]) -> Channel:
    schema = layout.schemas.get(record.schema)
    metadata = record.metadata
    type_hash = metadata.get("topic_type_hash") or hashes.get(record.topic, "")
    if schema is None:
        definition = Definition("", type_hash)
    else:
        # Any bytes: a copy has to have the same ones.
        text = schema.data.decode("utf-8", "surrogateescape")
        encoding = schema.encoding if text else ""
        definition = Definition(type_in(schema.name), type_hash, encoding, text)
    return Channel(
        record.topic, definition, read_qos(metadata.get("offered_qos_profiles", "")), record.encoding
    )
