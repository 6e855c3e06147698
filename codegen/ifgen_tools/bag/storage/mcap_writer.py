"""Writes an MCAP file as rosbag2's storage `mcap` does: its definitions, channels and metadata."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from ifgen_runtime.bag.mcap_writer import McapWriter
from ifgen_runtime.bag.qos import write_qos
from ifgen_runtime.bag.topics import Channel, Definition

CHUNK: Final = 2**20
_SECONDS: Final = 1.0
"""How long a message waits at most before it is in the file."""


class McapFileWriter:
    """An MCAP file that messages are added to."""

    def __init__(self, path: Path, compression: str, chunk_size: int = CHUNK) -> None:
        """Make the file. Raises BagError."""
        self._writer = McapWriter(path, compression, chunk_size, _SECONDS)
        self._schemas: dict[Definition, int] = {}
        self._numbers: dict[Channel, int] = {}

    def add(self, channel: Channel) -> int:
        """Add a channel, unless it is there; returns its number."""
        if channel in self._numbers:
            return self._numbers[channel]
        definition = channel.definition
        if definition not in self._schemas:
            self._schemas[definition] = self._writer.add_schema(
                definition.type_name, definition.encoding or "ros2msg", definition.text
            )
        metadata = {"offered_qos_profiles": write_qos(channel.qos), "topic_type_hash": definition.type_hash}
        number = self._writer.add_channel(
            self._schemas[definition], channel.topic, channel.encoding, metadata
        )
        self._numbers[channel] = number
        return number

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message."""
        self._writer.write(self._numbers[channel], received, published, data)

    def flush(self) -> None:
        """Write what waits."""
        self._writer.flush()

    def close(self, metadata: str = "") -> None:
        """Complete the file, with the text of metadata.yaml in it."""
        try:
            if metadata:
                self._writer.flush()
                self._writer.add_metadata("rosbag2", {"serialized_metadata": metadata})
        finally:
            self._writer.close()
