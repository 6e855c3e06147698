"""The messages of a rosbag2 database (`.db3`), in the order in which they were received."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from ifgen_runtime.bag.compression import LARGEST, ZSTD
from ifgen_runtime.bag.definitions import type_in
from ifgen_runtime.bag.errors import BagError, Damages
from ifgen_runtime.bag.qos import read_qos
from ifgen_runtime.bag.sqlite.rescue import Row, Span, TornPage, missing_bytes, sound_rows
from ifgen_runtime.bag.topics import Batch, Channel, Definition, Entry, Wanted

_BATCH: Final = 2**20
"""Bytes of messages that are read at once, or a little more."""

_BEGINNING: Final = b"SQLite format 3\0"
_HEADER: Final = 100


class SqliteFile:
    """A database of rosbag2, of any version. It is a `Source`.

    `hashes` are type hashes by topic, for a file that has none.
    """

    attachments = 0

    def __init__(self, path: Path, damages: Damages, hashes: Mapping[str, str]) -> None:
        self._path, self._damages = path, damages
        self._database, missing, self._torn = _opened(path)
        self._rows_left: list[Row] | None = None
        """The rows of a damaged database that can be read; None while nothing is wrong."""
        self.channels: dict[Channel, int] = {}
        self.start: int | None = None
        self.end: int | None = None
        self._by_number: dict[int, Channel] = {}
        try:
            self._require_tables()
            definitions = self._definitions()
            for number, channel in self._topics(definitions, hashes):
                self._by_number[number] = channel
                self.channels[channel] = 0
            if missing:
                self._rescue(f"{missing:,} bytes are missing at its end")
            else:
                self._measure()
        except sqlite3.Error as error:
            self.close()
            raise BagError(f"{path}: this database cannot be read: {error}") from None
        except BagError:
            self.close()
            raise

    def _rows(self, query: str, *values: Any) -> Iterator[Any]:
        try:
            with closing(self._database.execute(query, values)) as cursor:
                yield from cursor
        except (UnicodeError, OverflowError, MemoryError) as error:  # of a damaged file
            raise sqlite3.DatabaseError(str(error)) from None

    def _require_tables(self) -> None:
        """See that what we read are tables: views could compute anything."""
        query = "SELECT name, sql FROM sqlite_master WHERE type = 'table'"
        plain = {name for name, sql in self._rows(query) if str(sql).upper().startswith("CREATE TABLE")}
        missing = {"topics", "messages"} - plain
        if missing:
            raise BagError(
                f"{self._path}: this is no bag: it has no table {' and no table '.join(sorted(missing))}"
            )
        self._tables = plain
        for table in ("topics", "messages", "message_definitions"):
            if any(row[-1] > 1 for row in self._rows(f"PRAGMA table_xinfo({table})")):
                raise BagError(f"{self._path}: this is no bag: columns of its table {table} are computed")

    def _columns(self, table: str) -> set[str]:
        return (
            {row[1] for row in self._rows(f"PRAGMA table_info({table})")} if table in self._tables else set()
        )

    def _torn_rows(self, table: str) -> list[Span]:
        """The rows of a table that are not all there."""
        if self._torn is None:
            return []
        query = "SELECT rootpage FROM sqlite_master WHERE type = 'table' AND name = ?"
        return [span for (root,) in self._rows(query, table) for span in self._torn.rows(root)]

    def _whole_rows(self, table: str, columns: str) -> Iterator[list[Any]]:
        """These columns of the rows of a table that are all there."""
        torn = self._torn_rows(table)
        if not torn:
            yield from self._rows(f"SELECT {columns} FROM {table} ORDER BY rowid")
            return
        self._damages.note(self._path, None, f"the table {table} is not all there")
        for after, before in pairwise(
            [-(2**63), *(edge for span in sorted(torn) for edge in span), 2**63 - 1]
        ):
            condition = "rowid > ? AND rowid <= ?"
            if (after, before) not in torn:
                yield from self._rows(
                    f"SELECT {columns} FROM {table} WHERE {condition} ORDER BY rowid", after, before
                )

    def _definitions(self) -> dict[tuple[str, str], tuple[str, str, str]]:
        """Encoding, text and hash by the name of the type and the hash; files since ROS 2 Iron have them.

        The last one of a type has an empty hash as well, for topics without one.
        """
        columns = self._columns("message_definitions")
        if not columns >= {"topic_type", "encoding", "encoded_message_definition"}:
            return {}
        type_hash = "type_description_hash" if "type_description_hash" in columns else "''"
        found: dict[tuple[str, str], tuple[str, str, str]] = {}
        wanted = f"topic_type, encoding, encoded_message_definition, {type_hash}"
        for name, *texts in self._whole_rows("message_definitions", wanted):
            encoding, text, of = map(_text, texts)
            found[_text(name), of] = found[_text(name), ""] = encoding, text, of
        return found

    def _topics(
        self, definitions: dict[tuple[str, str], tuple[str, str, str]], hashes: Mapping[str, str]
    ) -> Iterator[tuple[int, Channel]]:
        columns = self._columns("topics")
        if not columns >= {"id", "name", "type", "serialization_format"}:
            raise BagError(f"{self._path}: this is no bag: its table of topics has other columns")
        optional = [
            name if name in columns else "''" for name in ("offered_qos_profiles", "type_description_hash")
        ]
        wanted = f"id, name, type, serialization_format, {', '.join(optional)}"
        for number, *texts in self._whole_rows("topics", wanted):
            name, type_name, serialization, qos, type_hash = map(_text, texts)
            known = definitions.get((type_name, type_hash)) or definitions.get((type_name, ""))
            encoding, text, hash_of_text = known or ("", "", "")
            definition = Definition(
                type_in(type_name),
                type_hash or hash_of_text or hashes.get(name, ""),
                encoding if text else "",
                text,
            )
            yield number, Channel(name, definition, read_qos(qos), serialization)

    @property
    def has_compressed_messages(self) -> bool:
        """Whether its messages are compressed by themselves: CDR does not begin as the first one."""
        try:
            first = [row[0] for row in self._rows("SELECT data FROM messages LIMIT 1")]
        except sqlite3.Error:
            return False
        return bool(first) and isinstance(first[0], bytes) and first[0].startswith(ZSTD)

    def _measure(self) -> None:
        """Find the first and the last time, and how many messages each topic has."""
        try:
            self.start, self.end = self._times()
            for number, count in self._rows("SELECT topic_id, count(*) FROM messages GROUP BY topic_id"):
                if number in self._by_number:
                    self.channels[self._by_number[number]] = count
        except sqlite3.Error as error:
            self._rescue(str(error))

    def _times(self) -> tuple[int | None, int | None]:
        query = "SELECT min(timestamp), max(timestamp) FROM messages"
        for condition in ("", " WHERE typeof(timestamp) = 'integer'"):  # the first one has an index
            for start, end in self._rows(query + condition):
                if isinstance(start, int) and isinstance(end, int):
                    return start, end
        return None, None

    def _rescue(self, damage: str) -> list[Row]:
        """Find the rows that can be read, and say so. Raises BagError if reading is strict."""
        rows = self._rows_left = sound_rows(self._database, self._torn_rows("messages"))
        counts = Counter(topic for _, _, topic in rows)
        self.channels = {channel: counts[number] for number, channel in self._by_number.items()}
        self.start, self.end = (rows[0][0], rows[-1][0]) if rows else (None, None)
        self._damages.note(self._path, None, f"{damage}; {len(rows):,} messages are not affected")
        return rows

    def batches(self, wanted: Wanted) -> Iterator[Batch]:
        """The messages in the order in which they were received, about a megabyte at a time."""
        channels = {n: channel for n, channel in self._by_number.items() if wanted.has_topic(channel.topic)}
        if not channels:
            return
        entries: list[Entry] = []
        size = 0
        for number, topic, received, data in self._in_order(wanted, channels):
            channel = channels.get(topic)
            if channel is None:
                continue
            if not isinstance(received, int) or not isinstance(data, bytes):
                self._damages.note(self._path, None, f"message {number} has no time, or no content")
                continue
            entries.append((received, received, channel, data))
            size += len(data)
            if size > _BATCH:
                yield Batch.of(entries)
                entries, size = [], 0
        if entries:
            yield Batch.of(entries)

    def _in_order(self, wanted: Wanted, channels: dict[int, Channel]) -> Iterator[tuple[int, Any, Any, Any]]:
        """Number, topic, time and content of messages, of all that are wanted and can be read."""
        last: tuple[int, int] | None = None
        rows = self._rows_left
        if rows is None:
            try:
                for row in self._rows(*_query(wanted, channels, self._by_number)):
                    yield row
                    last = row[2], row[0]
                return
            except sqlite3.Error as error:
                rows = self._rescue(str(error))
        for received, number, topic in rows:
            if (
                topic in channels
                and wanted.has_time(received)
                and (last is None or (received, number) > last)
            ):
                try:
                    (data,) = self._rows("SELECT data FROM messages WHERE id = ?", number)
                except (sqlite3.Error, ValueError) as error:
                    self._damages.note(self._path, None, f"message {number} cannot be read: {error}")
                    continue
                yield number, topic, received, data[0]

    def close(self) -> None:
        """Close the database."""
        self._database.close()


def _query(wanted: Wanted, channels: dict[int, Channel], known: dict[int, Channel]) -> list[Any]:
    """The query for messages, and its values."""
    conditions: list[str] = []
    values: list[Any] = []
    for limit, condition in ((wanted.start, "timestamp >= ?"), (wanted.end, "timestamp < ?")):
        if limit is not None:
            conditions.append(condition)
            values.append(max(-(2**63), min(limit, 2**63 - 1)))
    if len(channels) < len(known) and len(channels) < 100:
        conditions.append(f"topic_id IN ({', '.join('?' * len(channels))})")
        values += channels
    where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
    return [f"SELECT id, topic_id, timestamp, data FROM messages{where} ORDER BY timestamp, id", *values]


def _opened(path: Path) -> tuple[sqlite3.Connection, int, TornPage | None]:
    """Open a database without changing anything: neither it nor the files beside it.

    Returns also how many bytes it lacks at its end, and its last page if only a part of that is there.
    """
    try:
        with path.open("rb") as file:
            header = file.read(_HEADER)
    except OSError as error:
        raise BagError(f"{path}: cannot be opened: {error.strerror}") from None
    if not header.startswith(_BEGINNING):
        raise BagError(f"{path}: this is no SQLite database: it does not begin as one")
    # A log beside it has messages that are not in the database yet, as when a recorder was killed.
    log = path.with_name(f"{path.name}-wal")
    has_log = log.exists() and log.stat().st_size > 0
    address = f"file:{quote(str(path.resolve()))}?mode=ro{'' if has_log else '&immutable=1'}"
    try:
        database = sqlite3.connect(address, uri=True, check_same_thread=False)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(LARGEST - 1, path.stat().st_size + (1 << 20)))
        database.text_factory = _decoded
        missing = 0 if has_log else missing_bytes(path, header)
        if missing:  # otherwise SQLite reads nothing of it; nothing is written, whatever this is called
            database.execute("PRAGMA writable_schema = ON")
        torn = TornPage(path, header) if missing and len(header) == _HEADER else None
        return database, missing, torn
    except sqlite3.Error as error:
        raise BagError(f"{path}: this database cannot be opened: {error}") from None


def _decoded(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _text(value: object) -> str:
    return value if isinstance(value, str) else ""
