"""Finding work for an executor: look, sleep until something happens, and look again."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Iterator
from enum import Enum, auto
from typing import TYPE_CHECKING, Any

from rmw_local import timing

from rclpy._executor.callback_runner import TaskList, Work
from rclpy._executor.ready_queue import ReadyQueue
from rclpy._executor.watch import Watch
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.utilities import timeout_sec_to_nsec

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node

Condition = Callable[[], bool]  # true: there is nothing to wait for any more
MayExecute = Callable[[Any], bool]  # whether the executor may run a callback of this entity now
Find = Generator[Work | Watch, None, "End | None"]


class End(Enum):
    """The reason why there is nothing more to look for."""

    TIMEOUT = auto()  # nothing became ready in time
    SHUTDOWN = auto()  # the executor was shut down
    EXTERNAL_SHUTDOWN = auto()  # the context was shut down
    CONDITION = auto()  # what was waited for has happened


def never() -> bool:
    """Return False: the condition of a wait that has none."""
    return False


class WorkFinder:
    """Waits for what the entities of an executor's nodes have to do, and for its tasks."""

    def __init__(self, context: Context, queue: ReadyQueue, tasks: TaskList, nodes: Collection[Node]) -> None:
        self._context_handle = context.handle
        self._queue = queue
        self._tasks = tasks
        self._nodes = nodes  # the executor's own, which change

    def find(
        self,
        timeout_sec: float | None,
        nodes: list[Node] | None,
        condition: Condition,
        may_execute: MayExecute,
    ) -> Find:
        """Wait once; yield all that is ready: tasks, and watches whose callbacks are to be run.

        Arguments are those of `Executor._wait_for_ready_callbacks`. Returns the reason not to look again, or
        None if the next wait may find something.
        """
        queue = self._queue
        until, expired = self._deadline(timeout_sec) if timeout_sec is not None else (None, False)
        found = False
        while not found and not queue.closed and (condition is never or not condition()):
            if self._tasks:
                for work in self._runnable_tasks(nodes):
                    found = True
                    yield work
            if not self._context_handle.valid:
                raise _rclpy.RCLError(f"failed to initialize wait set: {_rclpy.CONTEXT_NOT_VALID}")
            ready = self.wait(until, nodes, may_execute, poll=expired)
            if ready is None:
                return End.SHUTDOWN if queue.closed else End.EXTERNAL_SHUTDOWN
            if until is not None and (queue.has_slept or not ready):
                expired = timing.monotonic_ns() >= until
            alone = len(ready) == 1  # then nothing can have changed since it was found
            for watch in ready:
                if alone or (watch.still_ready() and may_execute(watch.entity)):
                    found = True
                    yield watch
            if expired:
                return End.TIMEOUT
        if queue.closed:
            return End.SHUTDOWN
        return End.CONDITION if condition is not never and condition() else None

    def wait(
        self, until: int | None, nodes: list[Node] | None, may_execute: MayExecute, *, poll: bool
    ) -> list[Watch] | None:
        """Wait until something is ready, there is a poke, or it is `until` [ns, steady].

        None if the executor or its context was shut down meanwhile.
        """
        queue = self._queue
        inbox = queue.inbox
        queue.has_slept = False
        while True:
            if queue.stale or nodes is not None:
                self._watch_nodes(nodes)
            ready = queue.collect(may_execute, nodes)
            if ready or inbox.poked or poll:
                inbox.poked = False
                return ready
            if until is not None and timing.monotonic_ns() >= until:
                return ready
            queue.sleep(until)
            if queue.closed or not self._context_handle.valid:
                return None

    def _deadline(self, timeout_sec: float) -> tuple[int | None, bool]:
        """Return until when to wait [ns, steady] (None: no limit), and whether not to wait at all."""
        timeout = timeout_sec_to_nsec(timeout_sec)
        if timeout <= 0:
            return None, timeout == 0
        if not self._context_handle.valid:
            raise _rclpy.RCLError(f"failed to create timer: {_rclpy.CONTEXT_NOT_VALID}")
        return timing.monotonic_ns() + timeout, False

    def _watch_nodes(self, others: list[Node] | None) -> None:
        nodes = list(self._nodes)
        if others is not None:
            foreign = [node for node in others if node not in nodes]
            if not foreign and not self._queue.stale:
                return
            nodes += foreign
        self._queue.watch(nodes)

    def _runnable_tasks(self, nodes: list[Node] | None) -> Iterator[Work]:
        """Yield the tasks that are not done, newest first as Jazzy does; then forget those that are."""
        used = self._nodes if nodes is None else nodes
        some_done = False  # most rounds find only tasks that wait
        tasks = self._tasks[:]
        if not distro.follows("task_order"):
            tasks.reverse()
        for work in tasks:
            task, _, node = work
            if task._can_step() and (node is None or node in used):
                yield work
            some_done = some_done or not task._pending()
        if some_done:
            self._tasks.forget_done()
