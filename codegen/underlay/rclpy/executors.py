"""Executors: they wait for entities of nodes and run their callbacks.

The thread that spins owns the ready queue (`rclpy.impl.ready_queue`). Locks, each held for moments and none
while user code runs: `_nodes_lock`, `_tasks_lock`, `_shutdown_lock`; none is taken while another one is held.
"""

from __future__ import annotations

import inspect
import os
import warnings
from collections.abc import Callable, Coroutine, Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from threading import Lock, RLock
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

from rmw_local import timing

from rclpy.context import Context
from rclpy.guard_condition import GuardCondition
from rclpy.impl import sync_calls
from rclpy.impl.callback_runner import CallbackRunner, Work
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.ready_queue import ReadyQueue
from rclpy.impl.watch import Watch
from rclpy.signals import SignalHandlerGuardCondition
from rclpy.task import Future, Task
from rclpy.utilities import get_default_context, timeout_sec_to_nsec

if TYPE_CHECKING:
    from rclpy.node import Node

WaitableEntityType = TypeVar("WaitableEntityType")


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, and await what it returns if it is a coroutine function."""
    result = callback(*args)
    return await result if inspect.iscoroutinefunction(callback) else result


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


class Executor(CallbackRunner, AbstractContextManager["Executor"]):
    """Base of all executors: derive, implement `spin_once`, get work by `wait_for_ready_callbacks`.

    :param context: None for the default one. Its shutdown ends every wait.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__()
        self._sigint_gc: SignalHandlerGuardCondition | None = None
        self._context = get_default_context() if context is None else context
        self._context_handle = self._context.handle
        self._nodes: dict[Node, None] = {}  # a set with order
        self._nodes_lock = RLock()
        self._is_shutdown = False
        self._shutdown_lock = Lock()
        self._queue = ReadyQueue()
        self._guard: GuardCondition | None = GuardCondition(None, None, context=self._context)
        self._guard.handle.add_listener(self._queue.poke)
        self._sigint_gc = SignalHandlerGuardCondition(self._context)
        self._sigint_gc.handle.add_listener(self._queue.poke)
        self._cb_iter: Iterator[Work] | None = None  # what wait_for_ready_callbacks goes on with
        self._last_args: tuple[Any, ...] | None = None
        self._last_kwargs: dict[str, Any] | None = None
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        """The context of the executor."""
        return self._context

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task:
        """Run a function or coroutine while the executor spins; returns its future.

        The rest goes to the callback.
        """
        task = Task(callback, args, kwargs, executor=self)
        self._add_task(task, None, None)
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop executing; callbacks that run go on.

        :param timeout_sec: accepted for upstream's sake, where nothing is waited for either.
        :return: True.
        """
        with self._shutdown_lock:
            guard, self._guard = self._guard, None
            sigint_guard, self._sigint_gc = self._sigint_gc, None
            self._is_shutdown = True
        self._queue.poke()
        for condition in (guard, sigint_guard):
            if condition is not None:
                condition.destroy()
        with self._nodes_lock:
            self._nodes = {}
        self._queue.stale = True
        self._cb_iter = self._last_args = self._last_kwargs = None
        return True

    def add_node(self, node: Node) -> bool:
        """Execute the callbacks of a node; it leaves the executor where it was.

        False if it is here already.
        """
        with self._nodes_lock:
            if node in self._nodes:
                return False
            self._nodes[node] = None
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """Execute the callbacks of a node no more."""
        with self._nodes_lock:
            if node not in self._nodes:
                return
            del self._nodes[node]
        self.wake()

    def wake(self) -> None:
        """End a wait, because entities have come or gone or there is something else to look at."""
        self._queue.stale = True
        self._queue.poke()

    def get_nodes(self) -> list[Node]:
        """Return the nodes that were added."""
        with self._nodes_lock:
            return list(self._nodes)

    def spin(self) -> None:
        """Execute callbacks until the executor or its context is shut down."""
        while self._context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Execute callbacks until a future is done or given up, or for `timeout_sec` seconds."""
        _when_done(future, self._queue.poke)
        until = timing.deadline(timeout_sec)
        timeout: Timeout = None if until is None or timeout_sec is None else TimeoutObject(timeout_sec)
        while self._context.ok() and not future.done() and not future.cancelled() and not self._is_shutdown:
            self.spin_once_until_future_complete(future, timeout)
            if until is not None and isinstance(timeout, TimeoutObject):
                left = until - timing.monotonic_ns()
                if left <= 0:
                    return
                timeout.timeout = left / 1e9

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it; one thread at a time.

        :param timeout_sec: None or negative: no limit; 0: do not wait.
        """
        raise NotImplementedError()

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Timeout = None) -> None:
        """Do what `spin_once` does, but do not wait once the future is done."""
        raise NotImplementedError()

    def can_execute(self, entity: Any) -> bool:
        """Return whether an entity's callback group lets it run, and no handler of it is on its way."""
        return not entity._executor_event and entity.callback_group.can_execute(entity)

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Work:
        """Return the next (task, entity, node) to run: call the task.

        Arguments as `_wait_for_ready_callbacks`.

        What was found in one wait is handed out before the next one; other arguments start anew.
        """
        while True:
            if self._cb_iter is None or self._last_args != args or self._last_kwargs != kwargs:
                self._last_args = args
                self._last_kwargs = kwargs
                self._cb_iter = self._wait_for_ready_callbacks(*args, **kwargs)
            try:
                return next(self._cb_iter)
            except StopIteration:
                self._cb_iter = None

    def __enter__(self) -> Executor:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.shutdown()

    def _wait_for_ready_callbacks(
        self,
        timeout_sec: Timeout = None,
        nodes: list[Node] | None = None,
        condition: Callable[[], bool] = never,
    ) -> Generator[Work, None, None]:
        """Wait once; yield (task, entity, node) for all that is ready.

        :param timeout_sec: None or negative: no limit; 0: do not wait.
        :param nodes: only these nodes; None: all that were added.
        :param condition: do not wait once this is true.
        :raises TimeoutException: if the time is over.
        :raises ShutdownException: if the executor is shut down.
        :raises ExternalShutdownException: if the context is shut down.
        :raises ConditionReachedException: if the condition is true.
        """
        for item in self._find_work(timeout_sec, nodes, condition):
            yield self._make_handler(item) if isinstance(item, Watch) else item

    def _find_work(
        self, timeout_sec: Timeout, nodes: list[Node] | None, condition: Callable[[], bool]
    ) -> Generator[Work | Watch, None, None]:
        """Do what `_wait_for_ready_callbacks` says, but leave it to the caller how a watch is run."""
        timeout = timeout_sec_to_nsec(
            timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        )
        if timeout > 0 and not self._context_handle.valid:
            raise _rclpy.RCLError(f"failed to create timer: {_rclpy.CONTEXT_NOT_VALID}")
        until = timing.monotonic_ns() + timeout if timeout > 0 else None
        expired = timeout == 0
        found = False
        while not found and not self._is_shutdown and (condition is never or not condition()):
            for work in self._runnable_tasks(nodes) if self._tasks else ():
                found = True
                yield work
            if not self._context_handle.valid:
                raise _rclpy.RCLError(f"failed to initialize wait set: {_rclpy.CONTEXT_NOT_VALID}")
            ready = self._wait(until, nodes, poll=expired)
            if until is not None and self._queue.has_slept:
                expired = timing.monotonic_ns() >= until
            alone = len(ready) == 1  # then nothing can have changed since it was found
            for watch in ready:
                entity = watch.entity
                if alone or (watch.still_ready() and self.can_execute(entity)):
                    found = True
                    yield watch
            if expired:
                raise TimeoutException()
        if self._is_shutdown:
            raise ShutdownException()
        if condition():
            raise ConditionReachedException()

    def _wait(self, until: int | None, nodes: list[Node] | None, *, poll: bool) -> list[Watch]:
        """Wait until something is ready, there is a poke, or it is `until` [ns, steady]."""
        queue = self._queue
        queue.has_slept = False
        while True:
            if queue.stale or nodes is not None:
                self._watch_nodes(nodes)
            ready = queue.collect(self.can_execute, nodes)
            if ready or queue.poked or poll:
                queue.poked = False
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


class SingleThreadedExecutor(Executor):
    """Runs callbacks on the thread that spins."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._work: Iterator[Work | Watch] | None = None  # where the search for work stands
        self._work_timeout: Timeout = None  # the arguments of that search
        self._work_condition = never

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """See Executor."""
        self._spin_once_impl(timeout_sec)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Timeout = None) -> None:
        """See Executor."""
        _when_done(future, self._queue.poke)
        self._spin_once_impl(timeout_sec, future.done)

    def _spin_once_impl(
        self, timeout_sec: Timeout = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        work = self._work
        if work is None or self._work_timeout != timeout_sec or self._work_condition != wait_condition:
            self._work_timeout, self._work_condition = timeout_sec, wait_condition
            work = self._work = self._rounds(timeout_sec, wait_condition)
        try:
            item = next(work)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            self._work = None
            return
        except BaseException:
            self._work = None
            raise
        if isinstance(item, Watch):
            if sync_calls.enabled:
                with sync_calls.inside_callback(self, item.entity):
                    self._run(item)
            else:
                self._run(item)
            return
        task = item[0]
        task()
        if task.exception() is not None:
            task.result()  # raises it

    def _rounds(self, timeout: Timeout, condition: Callable[[], bool]) -> Iterator[Work | Watch]:
        """Search for work again and again, until an exception of `_wait_for_ready_callbacks` ends it."""
        while True:
            yield from self._find_work(timeout, None, condition)


class MultiThreadedExecutor(Executor):
    """Runs callbacks on a pool of threads. What a callback raises comes out of a later `spin_once`.

    :param num_threads: None: as many as there are CPUs for this process.
    :param context: None for the default one.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        if num_threads is None:
            affinity = getattr(os, "sched_getaffinity", None)
            num_threads = len(affinity(0)) if affinity else os.cpu_count() or 2
        if num_threads == 1:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\n"
                "Use the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        self._futures: list[Task] = []
        self._executor = ThreadPoolExecutor(num_threads)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """See Executor."""
        self._spin_once_impl(timeout_sec)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Timeout = None) -> None:
        """See Executor."""
        _when_done(future, self._queue.poke)
        self._spin_once_impl(timeout_sec, future.done)

    def _spin_once_impl(
        self, timeout_sec: Timeout = None, wait_condition: Callable[[], bool] = never
    ) -> None:
        try:
            task, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException):
            return
        self._executor.submit(task)
        if task not in self._futures:
            self._futures.append(task)
        for future in self._futures[:]:
            if future.done():
                self._futures.remove(future)
                future.result()  # raises what the callback has raised


def _when_done(future: Future, poke: Callable[[], None]) -> None:
    """Have a spinning thread woken when a future is done; as no task, which would outlive the wait."""
    if isinstance(future, Future):
        future._wake_when_done(poke)
    else:
        future.add_done_callback(lambda _: poke())
