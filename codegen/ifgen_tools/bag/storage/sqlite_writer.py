"""Writes a database as rosbag2's storage `sqlite3` has it (version 4 of its tables)."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Final

from ifgen_runtime.bag.qos import write_qos
from ifgen_runtime.bag.topics import Channel

_TABLES: Final = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
    offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
    id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
    id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
INSERT INTO schema VALUES (4, 'jazzy');
"""
_BATCH: Final = 2**22
"""Bytes of messages that are inserted at once: a crash loses at most these."""


class SqliteWriter:
    """A database that messages are added to, in the order in which they were received."""

    def __init__(self, path: Path) -> None:
        """Make the file. Raises sqlite3.Error."""
        self._database = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        # With a log beside it, a crash loses at most the last batch.
        self._database.executescript("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;" + _TABLES)
        self._numbers: dict[Channel, int] = {}
        self._defined: set[tuple[str, str]] = set()
        self._waiting: list[tuple[int, int, bytes]] = []
        self._size = 0

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message. The tables have no room for when it was published."""
        number = self._numbers.get(channel) or self.add(channel)
        self._waiting.append((number, received, data))
        self._size += len(data)
        if self._size >= _BATCH:
            self._flush()

    def add(self, channel: Channel) -> int:
        """Add a topic, unless it is there; returns its number."""
        if channel in self._numbers:
            return self._numbers[channel]
        number = self._numbers[channel] = len(self._numbers) + 1
        definition = channel.definition
        topic = (number, channel.topic, definition.type_name, channel.encoding)
        qos = write_qos(channel.qos)
        self._database.execute(
            "INSERT INTO topics VALUES (?, ?, ?, ?, ?, ?)", (*topic, qos, definition.type_hash)
        )
        if (key := (definition.type_name, definition.type_hash)) not in self._defined:
            self._defined.add(key)
            row = (
                definition.type_name,
                definition.encoding or "unknown",
                definition.text,
                definition.type_hash,
            )
            self._database.execute("INSERT INTO message_definitions VALUES (NULL, ?, ?, ?, ?)", row)
        return number

    def close(self, metadata: str = "") -> None:
        """Write what is left, the index of times, and the text of metadata.yaml; then close the file."""
        try:
            self._flush()
            self._database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
            if metadata:
                self._database.execute("INSERT INTO metadata VALUES (1, 9, ?)", (metadata,))
            self._database.execute("PRAGMA journal_mode = DELETE")
        finally:
            self._database.close()

    def _flush(self) -> None:
        self._database.execute("BEGIN")
        self._database.executemany("INSERT INTO messages VALUES (NULL, ?, ?, ?)", self._waiting)
        self._database.execute("COMMIT")
        self._waiting, self._size = [], 0
