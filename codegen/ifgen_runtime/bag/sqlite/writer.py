"""Writing a database as rosbag2's storage `sqlite3` has it (version 4 of its tables)."""

from __future__ import annotations

import sqlite3
import time
from collections import Counter
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.bag.metadata import FileFacts
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
"""Bytes of messages that are inserted at once."""


class SqliteWriter:
    """A database that messages are added to, in the order in which they were received. It is a `FileWriter`.

    What waits is written when it is 4 MB, or when the first of it has waited for `seconds`.
    """

    def __init__(self, path: Path, seconds: float) -> None:
        self.path = path
        self.facts = FileFacts(path.name)
        self._seconds = seconds
        self._numbers: dict[Channel, int] = {}
        self._defined: dict[tuple[str, str], tuple[str, str]] = {}
        self._waiting: list[tuple[int, int, bytes]] = []
        self._counts: Counter[Channel] = Counter()
        self._size = self._written = 0
        self._begun = 0.0
        with self._telling():
            self._database = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
            # With a log beside it, a crash loses at most what waits.
            self._database.executescript("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;" + _TABLES)

    @property
    def size(self) -> int:
        """Bytes of messages, written and waiting."""
        return self._written + self._size

    def add(self, channel: Channel) -> None:
        """Add a topic, unless it is there."""
        if channel in self._numbers:
            return
        number = self._numbers[channel] = len(self._numbers) + 1
        definition = channel.definition
        topic = (number, channel.topic, definition.type_name, channel.encoding)
        with self._telling():
            self._database.execute(
                "INSERT INTO topics VALUES (?, ?, ?, ?, ?, ?)",
                (*topic, write_qos(channel.qos), definition.type_hash),
            )
            key, new = (definition.type_name, definition.type_hash), (definition.encoding, definition.text)
            if key not in self._defined:
                self._defined[key] = new
                row = (key[0], definition.encoding or "unknown", definition.text, definition.type_hash)
                self._database.execute("INSERT INTO message_definitions VALUES (NULL, ?, ?, ?, ?)", row)
            elif self._defined[key] != new and not definition.type_hash:
                text = f"a database has room for one definition of {key[0]} without a hash, and there are two"
                raise BagError(f"{self.path}: {text}: write an MCAP file")

    def write(self, channel: Channel, received: int, published: int, data: bytes) -> None:
        """Add a message. The tables have no room for when it was published."""
        if not 0 <= received < 2**63:
            raise BagError(f"{self.path}: a time of {received} ns cannot be recorded")
        if not self._waiting:
            self._begun = time.monotonic()
        self._waiting.append((self._numbers[channel], received, data))
        self._counts[channel] += 1
        self._size += len(data)
        if self._size >= _BATCH:
            self.flush()
        else:
            self.flush_old()

    def flush_old(self) -> None:
        """Write what waits, if the first of it has waited for long enough."""
        if self._waiting and time.monotonic() - self._begun >= self._seconds:
            self.flush()

    def flush(self) -> None:
        """Write what waits."""
        if not self._waiting:
            return
        with self._telling():
            self._database.execute("BEGIN")
            self._database.executemany("INSERT INTO messages VALUES (NULL, ?, ?, ?)", self._waiting)
            self._database.execute("COMMIT")
        facts, times = self.facts, [received for _, received, _ in self._waiting]
        facts.start = min(times) if facts.start is None else min(facts.start, *times)
        facts.end = max(facts.end, *times)
        facts.counts += self._counts
        self._written += self._size
        self._waiting, self._counts, self._size = [], Counter(), 0

    def close(self, records: Mapping[str, Mapping[str, str]]) -> None:
        """Write the index of times, and the text of metadata.yaml; then close the file."""
        try:
            with self._telling():
                if self._database.in_transaction:  # of a batch that could not be written
                    self._database.execute("ROLLBACK")
                self._database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
                if text := records.get("rosbag2", {}).get("serialized_metadata"):
                    self._database.execute("INSERT INTO metadata VALUES (1, 9, ?)", (text,))
                self._database.execute("PRAGMA journal_mode = DELETE")
        finally:
            self._database.close()

    @contextmanager
    def _telling(self) -> Generator[None]:
        try:
            yield
        except UnicodeEncodeError:
            raise BagError(f"{self.path}: a database has no room for bytes that are no text") from None
        except sqlite3.Error as error:
            written = self.facts.counts.total()
            text = f"{self.path}: cannot be written any further: {error}. It has {written:,} messages"
            raise BagError(text) from error
