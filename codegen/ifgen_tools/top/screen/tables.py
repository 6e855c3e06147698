"""The tables: their columns, what each shows and sorts by, and figures as short texts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from ifgen_tools.top.snapshot import ExecutorRow, NodeRow, Snapshot, SubscriptionRow, TopicRow

UNKNOWN: Final = "-"
_PREFIXES: Final = ("", "k", "M", "G", "T")
_CUT: Final = "~"  # every terminal has it


@dataclass(frozen=True, slots=True)
class Column:
    """A column of `width` characters, or with 0 of what the others leave; `share` is its part of that."""

    title: str
    text: Callable[[Any], str]
    sorts_by: Callable[[Any], Any]
    width: int = 0
    share: int = 1

    @property
    def is_number(self) -> bool:
        """Whether it is aligned to the right, and sorted from the largest down."""
        return bool(self.width)


@dataclass(frozen=True, slots=True)
class Table:
    """A table of rows of one kind; `identity` tells one row from another, `nodes` are those of a row."""

    name: str
    columns: tuple[Column, ...]
    rows: Callable[[Snapshot], tuple[Any, ...]]
    identity: Callable[[Any], str]
    nodes: Callable[[Any], tuple[str, ...]]


def amount(value: float | None) -> str:
    """A number with three or four digits: `12.3`, `4.56k`."""
    if value is None:
        return UNKNOWN
    scaled, prefix = value, ""
    for prefix in _PREFIXES:  # noqa: B007  # the last one is used
        if scaled < 999.5:
            break
        scaled /= 1000
    digits = 0 if scaled >= 99.95 or not scaled else 1 if scaled >= 9.995 else 2
    return f"{scaled:.{digits}f}{prefix}"


def count(value: int | None) -> str:
    """A whole number."""
    return UNKNOWN if value is None else str(value)


def percent(value: float | None) -> str:
    """A part of one in percent."""
    return UNKNOWN if value is None else f"{100 * value:.0f}%"


def duration(seconds: float) -> str:
    """A time in the unit that fits: `850us`, `12.3ms`, `1.50s`."""
    if not seconds:
        return UNKNOWN
    if seconds < 1e-3:
        return f"{1e6 * seconds:.0f}us"
    if seconds < 1:
        return f"{1e3 * seconds:.1f}ms"
    return f"{seconds:.2f}s"


def queue(waiting: int, depth: int) -> str:
    """The number of waiting messages, and the most that can wait: `3/10`."""
    return f"{waiting}/{depth}" if depth else f"{waiting}/-"


def shortened(text: str, width: int) -> str:
    """The text in `width` characters: the end of a name says more than its middle."""
    if len(text) <= width:
        return text
    head = max(width // 3, 1)
    return f"{text[:head]}{_CUT}{text[len(text) - (width - head - 1) :]}"[:width]


def _number(title: str, name: str, text: Callable[[Any], str], width: int) -> Column:
    return Column(title, lambda row: text(getattr(row, name)), lambda row: getattr(row, name), width)


def _text(title: str, of: Callable[[Any], str], share: int = 1) -> Column:
    return Column(title, of, of, share=share)


def _topic_nodes(row: TopicRow) -> tuple[str, ...]:
    return (*row.publishers, *row.subscriptions)


def _callback(row: ExecutorRow) -> str:
    """The longest callback; whose it is goes without saying if there is one node."""
    return row.longest_is.removesuffix(f" of {row.nodes[0]}") if len(row.nodes) == 1 else row.longest_is


TOPICS: Final = Table(
    "topics",
    (
        _text("TOPIC", lambda row: row.name, 3),
        _text("TYPE", lambda row: ", ".join(row.types), 2),
        _number("Hz", "rate", amount, 5),
        _number("B/s", "bandwidth", amount, 6),
        Column("PUB", lambda row: count(len(row.publishers)), lambda row: len(row.publishers), 3),
        Column("SUB", lambda row: count(len(row.subscriptions)), lambda row: len(row.subscriptions), 3),
        _number("DROPS", "missed", count, 6),
        _number("QUEUE", "fill", percent, 5),
    ),
    lambda snapshot: snapshot.topics,
    lambda row: str(row.name),
    _topic_nodes,
)
NODES: Final = Table(
    "nodes",
    (
        _text("NODE", lambda row: row.name, 3),
        _text("PROCESS", lambda row: row.process or "-", 2),
        _number("PUB", "publishers", count, 4),
        _number("SUB", "subscriptions", count, 4),
        _number("SRV", "servers", count, 4),
        _number("CLI", "clients", count, 4),
        _number("LOAD", "load", percent, 5),
    ),
    lambda snapshot: snapshot.nodes,
    lambda row: str(row.name),
    lambda row: (row.name,),
)
SUBSCRIPTIONS: Final = Table(
    "subscriptions",
    (
        _text("TOPIC", lambda row: row.topic),
        _text("NODE", lambda row: row.node),
        Column("QUEUE", lambda row: queue(row.waiting, row.depth), lambda row: row.waiting, 9),
        _number("DROPPED", "dropped", count, 8),
        _number("LOST", "lost", count, 7),
    ),
    lambda snapshot: snapshot.subscriptions,
    lambda row: f"{row.topic} {row.node}",
    lambda row: (row.node,),
)
EXECUTORS: Final = Table(
    "executors",
    (
        _text("NODES", lambda row: " ".join(row.nodes), 3),
        _text("PROCESS", lambda row: row.process, 2),
        _number("THR", "threads", count, 3),
        _number("LOAD", "load", percent, 5),
        _number("CALLS", "rate", amount, 5),
        _number("LONGEST", "longest", duration, 7),
        _text("CALLBACK", _callback, 4),
    ),
    lambda snapshot: snapshot.executors,
    lambda row: f"{row.process} {row.kind} {' '.join(row.nodes)}",
    lambda row: tuple(row.nodes),
)
TABLES: Final[dict[str, Table]] = {each.name: each for each in (TOPICS, NODES, SUBSCRIPTIONS, EXECUTORS)}

Row = TopicRow | NodeRow | SubscriptionRow | ExecutorRow


def ordered(table: Table, rows: list[Any], column: int, *, is_reversed: bool) -> list[Any]:
    """Rows by a column: texts from A, numbers from the largest, and what is unknown last."""
    chosen = table.columns[column]
    known = [row for row in rows if chosen.sorts_by(row) is not None]
    unknown = [row for row in rows if chosen.sorts_by(row) is None]
    known.sort(key=chosen.sorts_by, reverse=chosen.is_number != is_reversed)
    return known + unknown


def widths(table: Table, width: int) -> list[int]:
    """The width of each column, in a line of this width with one space between two."""
    fixed = sum(column.width for column in table.columns) + len(table.columns) - 1
    free = max(width - fixed, 0)
    shares = sum(column.share for column in table.columns if not column.width)
    found = [column.width or free * column.share // shares for column in table.columns]
    found[0] += free - sum(
        each for each, column in zip(found, table.columns, strict=True) if not column.width
    )
    return found
