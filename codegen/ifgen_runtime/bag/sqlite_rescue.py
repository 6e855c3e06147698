"""The rows of a damaged database of rosbag2 that can still be read: those on sound pages."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Final, TypeAlias

Row: TypeAlias = tuple[int, int, int]
"""When a message was received [ns], its number, and that of its topic."""

_PLACES: Final = 1000
"""Damaged places after which reading goes on."""

_BATCH: Final = 1000
_FARTHEST: Final = 2**62
_PAGE_SIZE, _PAGES, _CHANGES, _COUNTED_AT = slice(16, 18), slice(28, 32), slice(24, 28), slice(92, 96)
"""Where the header of a database has the size of its pages, how many there are, and when that was true."""


def missing_bytes(path: Path, header: bytes) -> int:
    """How many bytes a database lacks at its end, as its first 100 bytes say."""
    if len(header) < 100 or header[_CHANGES] != header[_COUNTED_AT]:
        return 0
    page_size = int.from_bytes(header[_PAGE_SIZE], "big")
    whole = int.from_bytes(header[_PAGES], "big") * (65536 if page_size == 1 else page_size)
    return max(whole - path.stat().st_size, 0)


def sound_rows(database: sqlite3.Connection) -> list[Row]:
    """The messages whose rows can be read, in the order in which they were received.

    The table is read by the numbers of its rows, because the index of times may be what is damaged.
    """
    rows: list[Row] = []
    last = -(2**63)
    for _ in range(_PLACES):
        try:
            for number, received, topic in _after(database, last):
                last = number
                if isinstance(received, int) and isinstance(topic, int):
                    rows.append((received, number, topic))
            break
        except sqlite3.Error:
            beyond = _beyond_damage(database, max(last, 0))
            if beyond is None:
                break
            last = beyond
    return sorted(rows)


def _after(database: sqlite3.Connection, number: int) -> Iterator[tuple[int, object, object]]:
    """Number, time and topic of the messages after one, in batches; damaged ones may have other types.

    Python reads a row ahead, and loses it if the next one is damaged. So the last ones are read one by one.
    """
    size = _BATCH
    while True:
        query = "SELECT id, timestamp, topic_id FROM messages NOT INDEXED WHERE id > ? ORDER BY id LIMIT ?"
        try:
            with closing(database.execute(query, (number, size))) as cursor:
                found = cursor.fetchall()
        except sqlite3.Error:
            if size == 1:
                raise
            size = 1
            continue
        for row in found:
            if row[0] <= number:
                raise sqlite3.DatabaseError("its rows are in no order")
            number = row[0]
            yield row
        if not found:
            return


def _beyond_damage(database: sqlite3.Connection, last: int) -> int | None:
    """The lowest number after which rows can be read again; None if there is none."""
    step = 1
    while not _is_sound_after(database, last + step):
        step *= 2
        if step > _FARTHEST - last:
            return None
    low, high = step // 2, step  # the damage is still there after `low`, and not after `high`
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if _is_sound_after(database, last + middle) else (middle, high)
    return last + high


def _is_sound_after(database: sqlite3.Connection, number: int) -> bool:
    query = "SELECT id FROM messages NOT INDEXED WHERE id > ? ORDER BY id LIMIT 1"
    try:
        with closing(database.execute(query, (number,))) as cursor:
            row = cursor.fetchone()
    except sqlite3.Error:
        return False
    return row is None or row[0] > number
