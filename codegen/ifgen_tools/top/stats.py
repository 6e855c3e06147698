"""Statistics of processes of the local transport: their reports, and what changed between two of them.

A report is JSON that anybody may have sent.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from ifgen_runtime.errors import printable

from ifgen_tools.top.snapshot import ExecutorRow, SubscriptionRow

_VERSION: Final = 1
_LONGEST: Final = 4_000_000  # bytes of an answer
_MOST: Final = 2000  # entries of each kind
_LONGEST_TEXT: Final = 1000  # characters
_LARGEST: Final = 2**63
_SECOND: Final = 1e9  # [ns]


@dataclass(frozen=True, slots=True)
class Publisher:
    """A publisher, and the number of its last message."""

    node: str
    topic: str
    gid: str
    published: int


@dataclass(frozen=True, slots=True)
class Subscription:
    """A subscription: what waits, its depth (0: no limit), and what it has missed."""

    node: str
    topic: str
    gid: str
    waiting: int
    depth: int
    lost: int
    overwritten: int


@dataclass(frozen=True, slots=True)
class Executor:
    """An executor, since it is measured: for how long, and how long it was busy [ns]."""

    kind: str
    nodes: tuple[str, ...]
    threads: int
    measured: int
    busy: int
    callbacks: int
    longest: int
    longest_is: str


@dataclass(frozen=True, slots=True)
class Report:
    """The answer of one process; `clock` is its steady time [ns]."""

    pid: int
    program: str
    clock: int
    nodes: tuple[str, ...] = ()
    publishers: tuple[Publisher, ...] = ()
    subscriptions: tuple[Subscription, ...] = ()
    executors: tuple[Executor, ...] = field(default=())

    @property
    def process(self) -> str:
        """Its name for people."""
        return f"{self.program} {self.pid}"


def read_report(data: bytes) -> Report | None:
    """The report in an answer; None if it is none, or one of another version."""
    if len(data) > _LONGEST:
        return None
    try:
        found = json.loads(data)
        if not isinstance(found, dict) or found.get("version") != _VERSION:
            return None
        return Report(
            pid=_number(found["pid"]),
            program=_text(found["program"]),
            clock=_number(found["clock"]),
            nodes=tuple(map(_text, _list(found["nodes"]))),
            publishers=tuple(map(_publisher, _list(found["publishers"]))),
            subscriptions=tuple(map(_subscription, _list(found["subscriptions"]))),
            executors=tuple(map(_executor, _list(found["executors"]))),
        )
    except (ValueError, KeyError, TypeError, RecursionError):
        return None


def _publisher(value: Any) -> Publisher:
    return Publisher(
        _text(value["node"]), _text(value["topic"]), _text(value["gid"]), _number(value["published"])
    )


def _subscription(value: Any) -> Subscription:
    numbers = (_number(value[name]) for name in ("waiting", "depth", "lost", "overwritten"))
    return Subscription(_text(value["node"]), _text(value["topic"]), _text(value["gid"]), *numbers)


def _executor(value: Any) -> Executor:
    return Executor(
        kind=_text(value["kind"]),
        nodes=tuple(map(_text, _list(value["nodes"]))),
        threads=_number(value["threads"]),
        measured=_number(value["measured"]),
        busy=_number(value["busy"]),
        callbacks=_number(value["callbacks"]),
        longest=_number(value["longest"]),
        longest_is=_text(value["longest_is"]),
    )


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list) or len(value) > _MOST:
        raise ValueError
    return value


def _text(value: Any) -> str:
    """A text that can be printed: what came may have sequences that control a terminal."""
    if not isinstance(value, str) or len(value) > _LONGEST_TEXT:
        raise ValueError
    return printable(value)


def _number(value: Any) -> int:
    if type(value) is not int or not 0 <= value < _LARGEST:
        raise ValueError
    return value


@dataclass(slots=True)
class Stats:
    """The statistics from the last reports of the processes and those before."""

    rates: dict[str, float] = field(default_factory=dict)
    """Messages a second by topic, of the publishers that are known."""
    counted: dict[str, int] = field(default_factory=dict)
    """The number of these publishers by topic."""
    processes: dict[str, str] = field(default_factory=dict)
    """The process of each node."""
    loads: dict[str, float] = field(default_factory=dict)
    """The load of the executor of each node."""
    subscriptions: tuple[SubscriptionRow, ...] = ()
    executors: tuple[ExecutorRow, ...] = ()


def compare(earlier: Mapping[str, Report], now: Mapping[str, Report], without: str) -> Stats:
    """The statistics of reports by process, without those of one node, that of the tool."""
    found = Stats()
    executors: list[ExecutorRow] = []
    subscriptions: list[SubscriptionRow] = []
    for process, report in now.items():
        before = earlier.get(process)
        seconds = 0.0 if before is None else (report.clock - before.clock) / _SECOND
        found.processes.update((node, report.process) for node in report.nodes if node != without)
        _add_rates(found, before, report, seconds, without)
        executors += _executors(before, report, without)
        subscriptions += [
            SubscriptionRow(each.topic, each.node, each.waiting, each.depth, each.lost, each.overwritten)
            for each in report.subscriptions
            if each.node != without
        ]
    for executor in executors:
        if executor.load is not None:
            found.loads.update(dict.fromkeys(executor.nodes, executor.load))
    found.executors = tuple(sorted(executors, key=lambda each: (each.process, each.nodes, each.kind)))
    found.subscriptions = tuple(sorted(subscriptions, key=lambda each: (each.topic, each.node)))
    return found


def _add_rates(found: Stats, before: Report | None, report: Report, seconds: float, without: str) -> None:
    known = {} if before is None else {each.gid: each.published for each in before.publishers}
    for each in report.publishers:
        if each.node == without:
            continue
        found.counted[each.topic] = found.counted.get(each.topic, 0) + 1
        if seconds > 0 and each.gid in known:
            published = max(each.published - known[each.gid], 0)
            found.rates[each.topic] = found.rates.get(each.topic, 0.0) + published / seconds


def _executors(before: Report | None, report: Report, without: str) -> Iterable[ExecutorRow]:
    known = {} if before is None else {(each.kind, each.nodes): each for each in before.executors}
    for each in report.executors:
        nodes = tuple(node for node in each.nodes if node != without)
        if not nodes:
            continue
        earlier = known.get((each.kind, each.nodes))
        load, rate = _of_interval(earlier, each)
        yield ExecutorRow(
            report.process,
            each.kind,
            nodes,
            each.threads,
            load,
            rate,
            each.longest / _SECOND,
            each.longest_is,
        )


def _of_interval(earlier: Executor | None, now: Executor) -> tuple[float | None, float | None]:
    """Load and callbacks a second since the earlier report, or since measuring began, if it began again."""
    measured, busy, callbacks = now.measured, now.busy, now.callbacks
    if earlier is not None and earlier.measured < measured:
        measured -= earlier.measured
        busy = max(busy - earlier.busy, 0)
        callbacks = max(callbacks - earlier.callbacks, 0)
    if measured < _SECOND / 100:  # too short to say anything
        return None, None
    return busy / measured, callbacks / measured * _SECOND
