"""The files behind a `Bag`, merged by time, and the functions that read their messages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from heapq import merge
from itertools import islice
from operator import itemgetter
from pathlib import Path
from typing import Any, Final

from ifgen_runtime.bag import folder
from ifgen_runtime.bag.compression import Undecodable, decompress
from ifgen_runtime.bag.definitions import Classes, Decode, decoder
from ifgen_runtime.bag.errors import BagError, Damages
from ifgen_runtime.bag.topics import Batch, Channel, Definition, Entry, Recorded, Source, Topic, Wanted
from ifgen_runtime.errors import CodecError

_received = itemgetter(0)
_MERGED: Final = 256
"""Messages of several files that are merged at once."""


class Store:
    """The messages of the files of a recording."""

    def __init__(self, path: Path, damages: Damages, given: Mapping[str, type[Any]], views: bool) -> None:
        self.path = path
        self.damages = damages
        self.recording = folder.opened(path, damages)
        self.topics = _topics(self.recording)
        self.is_open = True
        self._views = views
        self._classes = Classes(given, str(path))
        self._decoders: dict[Channel, Decode] = {}

    def batches(self, wanted: Wanted) -> Iterator[Batch]:
        """Batches of messages of all files: one file after the other, unless their times overlap."""
        for group in _groups(self.recording.sources, wanted):
            if not self.is_open:
                raise BagError(f"{self.path}: this bag is closed")
            if len(group) == 1:
                yield from group[0].batches(wanted)
            else:
                merged = merge(*(_entries(source, wanted) for source in group), key=_received)
                while batch := Batch.of(islice(merged, _MERGED)):
                    yield batch

    def recorded(self, wanted: Wanted) -> Iterator[Recorded]:
        """The messages with their times."""
        compression = self.recording.compression
        for batch in self.batches(wanted):
            for entry in batch:
                if compression:
                    yield from self._decompressed(entry, compression)
                else:
                    yield Recorded(entry, self.decode)

    def _decompressed(self, entry: Entry, compression: str) -> Iterator[Recorded]:
        """A message that was compressed by itself; if it is damaged, a note of that."""
        received, published, channel, data = entry
        try:
            serialized = decompress(compression, data, None)
        except Undecodable as error:
            self._note(channel, error)
        else:
            yield Recorded((received, published, channel, serialized), self._decode_serialized)

    def _decode_serialized(self, channel: Channel, data: bytes) -> Any:
        """A message of bytes that are not compressed. Raises BagError."""
        try:
            return decoder(self._classes.of(channel), self._views)(data)
        except CodecError as error:
            raise BagError(f"{self.path}: a message of {channel.topic} cannot be read: {error}") from error

    def entries(self, wanted: Wanted) -> Iterator[Entry]:
        """The messages as they were published, without anything around them."""
        compression = self.recording.compression
        for batch in self.batches(wanted):
            if not compression:
                yield from batch
                continue
            for received, published, channel, data in batch:
                try:
                    plain = decompress(compression, data, None)
                except Undecodable as error:
                    text = f"a message of {channel.topic} cannot be read: {error}"
                    self.damages.note(self.path, None, text)
                else:
                    yield received, published, channel, plain

    def class_for(self, channel: Channel) -> type[Any]:
        """The class of a channel's messages. Raises BagError if there is none."""
        return self._classes.of(channel)

    def decode(self, channel: Channel, data: bytes) -> Any:
        """A message. Raises BagError."""
        decode = self._decoders.get(channel) or self.decoder_of(channel)
        try:
            return decode(data)
        except (CodecError, Undecodable) as error:
            raise BagError(f"{self.path}: a message of {channel.topic} cannot be read: {error}") from error

    def messages(self, wanted: Wanted) -> Iterator[Any]:
        """The messages. One that cannot be read is damage."""
        for batch in self.batches(wanted):
            for channel, data in batch.runs():
                decode = self.decoder_of(channel)
                while True:
                    try:
                        yield from map(decode, data)
                        break
                    except (CodecError, Undecodable) as error:
                        self._note(channel, error)  # and go on with the next one

    def messages_with_times(self, wanted: Wanted) -> Iterator[tuple[int, Any]]:
        """When each message was received [ns], and the message."""
        for batch in self.batches(wanted):
            for received, _, channel, data in batch:
                try:
                    message = self.decoder_of(channel)(data)
                except (CodecError, Undecodable) as error:
                    self._note(channel, error)
                else:
                    yield received, message

    def _note(self, channel: Channel, error: Exception) -> None:
        self.damages.note(self.path, None, f"a message of {channel.topic} cannot be read: {error}")

    def decoder_of(self, channel: Channel) -> Decode:
        """The function that makes a channel's messages. Raises BagError if there is no class for them."""
        decode = self._decoders.get(channel)
        if decode is None:
            plain = decoder(self._classes.of(channel), self._views)
            compression = self.recording.compression
            if compression:
                decode = self._decoders[channel] = lambda data: plain(decompress(compression, data, None))
            else:
                decode = self._decoders[channel] = plain
        return decode

    def class_of(self, topic: str) -> type[Any]:
        """The class of a topic's messages. Raises BagError if there is none, or if there are two."""
        sources = self.recording.sources
        channels = (channel for source in sources for channel in source.channels if channel.topic == topic)
        classes = {self._classes.of(channel) for channel in channels}
        if len(classes) > 1:
            text = f"{topic} has messages of {len(classes)} definitions: read them one by one"
            raise BagError(f"{self.path}: {text}")
        return classes.pop()


def _entries(source: Source, wanted: Wanted) -> Iterator[Entry]:
    for batch in source.batches(wanted):
        yield from batch


def _groups(sources: list[Source], wanted: Wanted) -> Iterator[list[Source]]:
    """Files whose times overlap, together; the groups in the order of their times."""
    having = [
        s for s in sources if s.start is not None and s.end is not None and wanted.overlaps(s.start, s.end)
    ]
    group: list[Source] = []
    end = 0
    for source in sorted(having, key=lambda source: source.start or 0):
        if group and (source.start or 0) > end:
            yield group
            group = []
        end = max(end, source.end or 0) if group else source.end or 0
        group.append(source)
    if group:
        yield group


def _topics(recording: folder.Recording) -> dict[str, Topic]:
    """The topics of all files. What the metadata of a folder says fills in what files do not."""
    found: dict[str, list[tuple[Channel, int]]] = {}
    for source in recording.sources:
        for channel, count in source.channels.items():
            found.setdefault(channel.topic, []).append((channel, count))
    return {name: _topic(name, found[name], recording) for name in sorted(found)}


def _topic(name: str, channels: list[tuple[Channel, int]], recording: folder.Recording) -> Topic:
    definitions: dict[Definition, None] = {channel.definition: None for channel, _ in channels}
    qos = dict.fromkeys(profile for channel, _ in channels for profile in channel.qos)
    count = sum(count for _, count in channels)
    return Topic(
        name,
        tuple(definitions),
        tuple(qos) or recording.qos.get(name, ()),
        count,
        channels[0][0].encoding,
    )
