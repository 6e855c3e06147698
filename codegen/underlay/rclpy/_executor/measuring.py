"""How busy an executor is, and which callback takes longest: measured while somebody asks."""

from __future__ import annotations

import _thread
import re
import time
from typing import TYPE_CHECKING, Any, Final
from weakref import ref

from rclpy._executor.callback_runner import CallbackRunner

if TYPE_CHECKING:
    from rclpy._executor.callback_runner import Work
    from rclpy._executor.watch import Watch
    from rclpy.executors import Executor

_MOST_NODES: Final = 100
"""The number of an executor's nodes that are named."""
_LONGEST: Final = 200  # characters of a callback's name


class Meter:
    """Measures an executor by a runner of its own (`rmw_local.statistics.Meter`)."""

    def __init__(self, executor: Executor) -> None:
        self._executor = ref(executor)
        self._tally = Tally()

    def measure(self, is_wanted: bool) -> None:
        """Put a measuring runner in the place of the executor's, or that one back."""
        executor = self._executor()
        if executor is None:
            return
        runner = executor._runner
        if is_wanted and not isinstance(runner, MeasuringRunner):
            self._tally = Tally()
            executor._runner = MeasuringRunner(runner, self._tally)
        elif not is_wanted and isinstance(runner, MeasuringRunner):
            executor._runner = runner.inner

    def figures(self) -> dict[str, Any] | None:
        """The figures since measuring began; None if the executor is gone."""
        executor = self._executor()
        if executor is None or executor._queue.closed:
            return None
        nodes = list(executor._nodes)[:_MOST_NODES]
        pool = getattr(executor, "_executor", None)
        return {
            "kind": type(executor).__name__,
            "nodes": [node.handle.graph_node.full_name for node in nodes],
            "threads": getattr(pool, "_max_workers", 1),
            **self._tally.figures(),
        }


class Tally:
    """The times of callbacks, those that still run included."""

    def __init__(self) -> None:
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._since = time.monotonic_ns()
        self._busy = self._callbacks = self._longest = 0
        self._longest_is = ""
        self._running: dict[int, tuple[int, Any, Any]] = {}  # by thread: when it began, entity, node

    def begin(self, entity: Any, node: Any) -> tuple[int, Any, Any] | None:
        """Note that a callback begins on this thread; returns the one that it interrupts, for `end`."""
        thread = _thread.get_ident()
        outer = self._running.get(thread)
        self._running[thread] = outer or (time.monotonic_ns(), entity, node)
        return outer

    def end(self, outer: tuple[int, Any, Any] | None) -> None:
        """Note that it has ended. One within another, which spins itself, is part of that."""
        if outer is not None:
            return
        with self._lock:
            began, entity, node = self._running.pop(_thread.get_ident())
            took = time.monotonic_ns() - began
            self._busy += took
            self._callbacks += 1
            if took > self._longest:
                self._longest, self._longest_is = took, name_of(entity, node)

    def figures(self) -> dict[str, Any]:
        """The figures until now [ns]."""
        now = time.monotonic_ns()
        with self._lock:
            busy, longest, longest_is = self._busy, self._longest, self._longest_is
            callbacks, running = self._callbacks, list(self._running.values())
        for began, entity, node in running:
            busy += now - began
            if now - began > longest:
                longest, longest_is = now - began, name_of(entity, node)
        return {
            "measured": now - self._since,
            "busy": busy,
            "callbacks": callbacks,
            "longest": longest,
            "longest_is": longest_is,
        }


class MeasuringRunner(CallbackRunner):
    """Does what another runner does, and keeps the time."""

    def __init__(self, inner: CallbackRunner, tally: Tally) -> None:
        super().__init__(inner._queue, inner._tasks)
        self.inner = inner
        self._tally = tally

    def run(self, watch: Watch, executor: Executor) -> None:
        """As `CallbackRunner.run`."""
        outer = self._tally.begin(watch.entity, watch.node)
        try:
            self.inner.run(watch, executor)
        finally:
            self._tally.end(outer)

    def run_task(self, work: Work) -> None:
        """As `CallbackRunner.run_task`."""
        outer = self._tally.begin(*_whose(work))
        try:
            self.inner.run_task(work)
        finally:
            self._tally.end(outer)

    def run_in_pool(self, work: Work) -> None:
        """As `CallbackRunner.run_in_pool`."""
        outer = self._tally.begin(*_whose(work))
        try:
            self.inner.run_in_pool(work)
        finally:
            self._tally.end(outer)


def name_of(entity: Any, node: Any) -> str:
    """A name for people: what the callback belongs to, and whose it is. A name stays as it is."""
    if isinstance(entity, str):
        return entity
    kind = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(entity).__name__).lower()
    whose = "" if node is None else f" of {node.handle.graph_node.full_name}"
    return f"{kind}{_what(entity)}{whose}"[:_LONGEST]


def _whose(work: Work) -> tuple[Any, Any]:
    task, entity, node = work
    return name_of(task, node) if entity is None else entity, node  # a task that is done has no name


def _what(entity: Any) -> str:
    for name in ("topic_name", "service_name", "srv_name", "_action_name"):
        try:
            value = getattr(entity, name)
        except Exception:  # destroyed meanwhile, or no such thing
            continue
        return f" {value}"
    callback = getattr(entity, "callback", None) or getattr(entity, "_handler", None)
    found = getattr(getattr(callback, "func", callback), "__qualname__", "")
    return f" {found}" if isinstance(found, str) and found else ""
