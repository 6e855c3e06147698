"""How an executor finds something to do: it looks, sleeps until something happens, and looks again."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from threading import RLock
from typing import TYPE_CHECKING, Any

from rmw_local import timing

from rclpy._executor.callback_runner import CallbackRunner, Work
from rclpy._executor.watch import Watch
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.utilities import timeout_sec_to_nsec

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node


class TimeoutException(Exception):
    """Nothing became ready in time."""


class ShutdownException(Exception):
    """The executor was shut down."""


class ExternalShutdownException(Exception):
    """The context was shut down."""


class ConditionReachedException(Exception):
    """What was waited for has happened."""


class TimeoutObject:
    """A timeout [s] that changes from one wait to the next."""

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout

    @property
    def timeout(self) -> float:
        """Seconds left."""
        return self._timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._timeout = timeout


Timeout = float | TimeoutObject | None


def never() -> bool:
    """Return False: the condition of a wait that has none."""
    return False


class WorkFinder(CallbackRunner):
    """The part of an executor that knows nodes and waits for what their entities have to do."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context_handle = context.handle
        self._nodes: dict[Node, None] = {}  # a set with order
        self._nodes_lock = RLock()

    def get_nodes(self) -> list[Node]:
        """Return the nodes that were added."""
        with self._nodes_lock:
            return list(self._nodes)

    def can_execute(self, entity: Any) -> bool:
        """Return whether an entity's callback group lets it run, and no handler of it is on its way."""
        return not entity._executor_event and entity.callback_group.can_execute(entity)

    def _find_work(
        self, timeout_sec: Timeout, nodes: list[Node] | None, condition: Callable[[], bool]
    ) -> Generator[Work | Watch, None, None]:
        """Wait once; yield all that is ready: tasks, and watches whose callbacks are to be run.

        Arguments and exceptions are those of `Executor._wait_for_ready_callbacks`.
        """
        until, expired = self._deadline(timeout_sec) if timeout_sec is not None else (None, False)
        found = False
        while not found and not self._is_shutdown and (condition is never or not condition()):
            for work in self._runnable_tasks(nodes) if self._tasks else ():
                found = True
                yield work
            if not self._context_handle.valid:
                raise _rclpy.RCLError(f"failed to initialize wait set: {_rclpy.CONTEXT_NOT_VALID}")
            ready = self._wait(until, nodes, poll=expired)
            if until is not None and (self._queue.has_slept or not ready):
                expired = timing.monotonic_ns() >= until
            alone = len(ready) == 1  # then nothing can have changed since it was found
            for watch in ready:
                if alone or (watch.still_ready() and self.can_execute(watch.entity)):
                    found = True
                    yield watch
            if expired:
                raise TimeoutException()
        if self._is_shutdown:
            raise ShutdownException()
        if condition is not never and condition():
            raise ConditionReachedException()

    def _deadline(self, timeout_sec: float | TimeoutObject) -> tuple[int | None, bool]:
        """Return until when to wait [ns, steady] (None: no limit), and whether not to wait at all."""
        timeout = timeout_sec_to_nsec(
            timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        )
        if timeout <= 0:
            return None, timeout == 0
        if not self._context_handle.valid:
            raise _rclpy.RCLError(f"failed to create timer: {_rclpy.CONTEXT_NOT_VALID}")
        return timing.monotonic_ns() + timeout, False

    def _wait(self, until: int | None, nodes: list[Node] | None, *, poll: bool) -> list[Watch]:
        """Wait until something is ready, there is a poke, or it is `until` [ns, steady]."""
        queue = self._queue
        inbox = queue.inbox
        queue.has_slept = False
        while True:
            if queue.stale or nodes is not None:
                self._watch_nodes(nodes)
            ready = queue.collect(self.can_execute, nodes)
            if ready or inbox.poked or poll:
                inbox.poked = False
                return ready
            if until is not None and timing.monotonic_ns() >= until:
                return ready
            queue.sleep(until)
            if self._is_shutdown:
                raise ShutdownException()
            if not self._context_handle.valid:
                raise ExternalShutdownException()

    def _watch_nodes(self, others: list[Node] | None) -> None:
        nodes = self.get_nodes()
        if others is not None:
            foreign = [node for node in others if node not in nodes]
            if not foreign and not self._queue.stale:
                return
            nodes += foreign
        self._queue.watch(nodes)

    def _runnable_tasks(self, nodes: list[Node] | None) -> Iterator[Work]:
        """Yield the tasks that are not done, newest first; then forget those that are."""
        for work in reversed(self._tasks[:]):
            task, _, node = work
            if task._pending() and not task.executing() and (node is None or self._uses(node, nodes)):
                yield work
        with self._tasks_lock:
            self._tasks = [work for work in self._tasks if work[0]._pending()]

    def _uses(self, node: Node, nodes: list[Node] | None) -> bool:
        return node in (self._nodes if nodes is None else nodes)
