"""The rows of a damaged database of rosbag2 that can still be read: those on sound pages."""

from __future__ import annotations

import mmap
import sqlite3
from collections.abc import Iterator, Sequence
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
"""The places in the header of a database: the size of its pages, their number, and when that was true."""

_RESERVED: Final = 20
"""The byte in the header with the number of bytes at the end of each page that SQLite does not use."""

_LEAF, _INTERIOR = 0x0D, 0x05
"""The first bytes of the two kinds of pages of a table."""

_LEAST: Final = 480
"""Bytes of a page that SQLite needs."""

Span: TypeAlias = tuple[int, int]
"""Numbers of rows: after the first, up to the second."""


def missing_bytes(path: Path, header: bytes) -> int:
    """How many bytes a database lacks at its end, by its size or by its first 100 bytes."""
    page_size, size = _page_size(header), path.stat().st_size
    torn = -size % page_size if page_size else 0
    if len(header) < 100 or header[_CHANGES] != header[_COUNTED_AT]:
        return torn
    return max(int.from_bytes(header[_PAGES], "big") * page_size - size, torn)


def _page_size(header: bytes) -> int:
    size = int.from_bytes(header[_PAGE_SIZE], "big")
    return 65536 if size == 1 else size


class TornPage:
    """The page within which a file was cut off, and those after it.

    SQLite reads zeros where bytes of the last page are missing.
    """

    def __init__(self, path: Path, header: bytes) -> None:
        self._page_size = _page_size(header)
        self._usable = self._page_size - header[_RESERVED]
        with path.open("rb") as file:
            self._bytes = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._torn = len(self._bytes) // self._page_size + 1

    def rows(self, root: int) -> list[Span]:
        """The rows of a table that may have a part there, by the page that its tree begins with."""
        spans: list[Span] = []
        if self._usable < _LEAST:
            return spans
        pages: list[tuple[int, Span]] = [(root, (-(2**63), 2**63 - 1))]
        seen: set[int] = set()
        while pages:
            number, span = pages.pop()
            if number >= self._torn:
                spans.append(span)
            if number in seen or not 0 < number < self._torn:
                continue
            seen.add(number)
            try:
                for child, part in self._children(number, span):
                    if child:
                        pages.append((child, part))
                    else:
                        spans.append(part)
            except IndexError:  # what is not a page of a table: SQLite reports it
                continue
        return spans

    def _children(self, number: int, span: Span) -> Iterator[tuple[int, Span]]:
        """The pages below a page with their rows; 0 in place of a page for a row that has a part there."""
        data, begin = self._bytes, (number - 1) * self._page_size
        head = begin + (100 if number == 1 else 0)
        kind, cells, low = data[head], self._number(head + 3, 2), span[0]
        if kind not in (_LEAF, _INTERIOR):
            return
        for index in range(cells):
            pointer = head + (12 if kind == _INTERIOR else 8) + 2 * index
            at = begin + self._number(pointer, 2)
            if kind == _INTERIOR:
                row, _ = self._varint(at + 4)
                yield self._number(at, 4), (low, row)
                low = row
            else:
                size, at = self._varint(at)
                row, at = self._varint(at)
                if self._reaches(size, at):
                    yield 0, (row - 1, row)
        if kind == _INTERIOR:
            yield self._number(head + 8, 4), (low, span[1])

    def _reaches(self, size: int, at: int) -> bool:
        """Whether the content of a row, which begins there, goes on to the torn page or beyond."""
        usable = self._usable
        if size <= usable - 35:
            return False
        least = (usable - 12) * 32 // 255 - 23
        local = least + (size - least) % (usable - 4)
        page = self._number(at + (local if local <= usable - 35 else least), 4)
        for _ in range(min(size // (usable - 4) + 1, self._torn)):
            if not 0 < page < self._torn:
                return page >= self._torn
            page = self._number((page - 1) * self._page_size, 4)
        return False

    def _number(self, at: int, size: int) -> int:
        return int.from_bytes(self._bytes[at : at + size], "big")

    def _varint(self, at: int) -> tuple[int, int]:
        """A number of SQLite, of up to nine bytes, and the place after it."""
        value = 0
        for index in range(9):
            byte = self._bytes[at + index]
            if index == 8:
                value = value << 8 | byte
            elif byte < 0x80:
                return value << 7 | byte, at + index + 1
            else:
                value = value << 7 | byte & 0x7F
        return value - 2**64 if value >= 2**63 else value, at + 9


def is_in(number: int, spans: Sequence[Span]) -> bool:
    """Whether a row is one of these."""
    return any(after < number <= last for after, last in spans)


def sound_rows(database: sqlite3.Connection, torn: Sequence[Span] = ()) -> list[Row]:
    """The messages whose rows can be read, in the order in which they were received; without `torn` ones.

    The table is read by the numbers of its rows, because the index of times may be what is damaged.
    """
    rows: list[Row] = []
    last = -(2**63)
    for _ in range(_PLACES):
        try:
            for number, received, topic in _after(database, last):
                last = number
                if isinstance(received, int) and isinstance(topic, int) and not is_in(number, torn):
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
