"""Figures over time from the reports of processes: what has changed between two answers of one process."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from ifgen_tools.top.reports import Executor, Report
from ifgen_tools.top.snapshot import ExecutorRow, SubscriptionRow

_SECOND = 1e9  # [ns]


@dataclass(slots=True)
class Figures:
    """The figures from the processes' last reports and those before."""

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


def compare(earlier: Mapping[str, Report], now: Mapping[str, Report], without: str) -> Figures:
    """The figures of reports by process, without those of one node, that of the tool."""
    found = Figures()
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


def _add_rates(found: Figures, before: Report | None, report: Report, seconds: float, without: str) -> None:
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
