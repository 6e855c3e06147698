"""Executors: they wait for entities of nodes and run their callbacks.

An executor has a finder of work, which waits, and a runner of callbacks. Both know its ready queue and its
tasks. The thread that spins owns the ready queue. Locks are `_nodes_lock`, `_shutdown_lock` and that of the
tasks. Each is held briefly, never while user code runs, and never while another one is held.
"""

from __future__ import annotations

import inspect
import os
import threading
import warnings
from collections.abc import Callable, Coroutine, Generator, Iterator
from contextlib import AbstractContextManager
from threading import Lock, RLock
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar, overload

from rmw_local import timing

from rclpy._executor.callback_runner import CallbackRunner, TaskList, Work, wake_when_done
from rclpy._executor.measuring import Meter
from rclpy._executor.ready_queue import ReadyQueue
from rclpy._executor.watch import Watch
from rclpy._executor.work_finder import Condition, End, WorkFinder, never
from rclpy.context import Context
from rclpy.guard_condition import GuardCondition
from rclpy.impl import blocking
from rclpy.impl.reexports import reexport
from rclpy.signals import SignalHandlerGuardCondition
from rclpy.task import Future, Task
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.impl.typed import P, T
    from rclpy.node import Node

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

WaitableEntityType = TypeVar("WaitableEntityType")

_ALREADY_SPINNING = (
    "Executor is already spinning: in a callback, `await` the future, or spin with another executor "
    "(`executor=`); a blocking call needs another callback group and a MultiThreadedExecutor"
)


class TimeoutException(Exception):
    """Nothing became ready in time."""


class ShutdownException(Exception):
    """The executor was shut down."""


class ExternalShutdownException(Exception):
    """The context was shut down."""


class ConditionReachedException(Exception):
    """The awaited condition is true."""


_EXCEPTIONS = {
    End.TIMEOUT: TimeoutException,
    End.SHUTDOWN: ShutdownException,
    End.EXTERNAL_SHUTDOWN: ExternalShutdownException,
    End.CONDITION: ConditionReachedException,
}


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


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, and await what it returns if it is a coroutine function."""
    result = callback(*args)
    # Asked in this order because inspect takes longer than most callbacks.
    return await result if hasattr(result, "__await__") and inspect.iscoroutinefunction(callback) else result


class Executor(AbstractContextManager["Executor"]):
    """Base of all executors: derive, implement `spin_once`, get work by `wait_for_ready_callbacks`.

    :param context: None for the default one. Its shutdown ends every wait.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        self._sigint_gc: SignalHandlerGuardCondition | None = None
        self._context = get_default_context() if context is None else context
        self._nodes: dict[Node, None] = {}  # a set with order
        self._nodes_lock = RLock()
        self._shutdown_lock = Lock()
        self._queue = ReadyQueue()
        self._tasks = TaskList()
        self._finder = WorkFinder(self._context, self._queue, self._tasks, self._nodes)
        self._runner = CallbackRunner(self._queue, self._tasks)
        self._meter = Meter(self)
        domain = self._context.handle.participant.domain
        with domain.lock:
            domain.meters.add(self._meter)
        self._guard: GuardCondition | None = GuardCondition(None, None, context=self._context)
        self._guard.handle.add_listener(self._queue.poke)
        self._sigint_gc = SignalHandlerGuardCondition(self._context)
        self._sigint_gc.handle.add_listener(self._queue.poke)
        self._cb_iter: Iterator[Work] | None = None  # what wait_for_ready_callbacks goes on with
        self._last_args: tuple[Any, ...] | None = None
        self._last_kwargs: dict[str, Any] | None = None
        self._turn = [None]  # the right to spin, which whoever spins pops; a lock takes five times as long
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        """The context of the executor."""
        return self._context

    @property
    def is_spinning(self) -> bool:
        """Whether a thread is in one of the methods that spin."""
        return not self._turn

    @property
    def _is_shutdown(self) -> bool:  # programs ask for it
        return self._queue.closed

    @overload
    def create_task(self, callback: Coroutine[Any, Any, T]) -> Task[T]: ...
    @overload
    def create_task(
        self, callback: Callable[P, Coroutine[Any, Any, T]], *args: P.args, **kwargs: P.kwargs
    ) -> Task[T]: ...
    @overload
    def create_task(self, callback: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> Task[T]: ...
    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task[Any]:
        """Run a function or coroutine while the executor spins; returns its future.

        The rest goes to the callback.
        """
        task: Task[Any] = Task(callback, args, kwargs, executor=self)
        self._tasks.add(task, None, None)
        self._queue.poke()
        return task

    def create_future(self) -> Future:
        """Return a future whose done-callbacks and awaiting tasks run here. Jazzy has this since 7.1.7."""
        return Future(executor=self)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop executing; callbacks that run go on.

        :param timeout_sec: accepted for upstream's sake, where nothing is waited for either.
        :return: True.
        """
        with self._shutdown_lock:
            guard, self._guard = self._guard, None
            sigint_guard, self._sigint_gc = self._sigint_gc, None
        self._queue.close()
        for condition in (guard, sigint_guard):
            if condition is not None:
                condition.destroy()
        with self._nodes_lock:
            self._nodes.clear()
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

    def get_nodes(self) -> list[Node]:
        """Return the nodes that were added."""
        with self._nodes_lock:
            return list(self._nodes)

    def can_execute(self, entity: Any) -> bool:
        """Return whether an entity's callback group lets it run, and no handler of it is on its way."""
        return not entity._executor_event and entity.callback_group.can_execute(entity)

    def wake(self) -> None:
        """End a wait, because entities have come or gone or there is something else to look at."""
        self._queue.stale = True
        self._queue.poke()

    def spin(self) -> None:
        """Execute callbacks until the executor or its context is shut down.

        :raises RuntimeError: if it spins already.
        """
        queue = self._queue
        once = self.spin_once
        is_own = getattr(once, "__func__", None) is Executor.spin_once  # else each round starts by itself
        turn = self._turn
        if is_own:
            try:
                turn.pop()
            except IndexError:
                raise RuntimeError(_ALREADY_SPINNING) from None
            once = self._spin_once_impl
        try:
            while self._context.ok() and not queue.closed:
                once()
        finally:
            if is_own:
                turn.append(None)
            self._context._call_back()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Execute callbacks until a future is done or given up, or for `timeout_sec` seconds.

        :raises RuntimeError: if it spins already.
        """
        queue = self._queue
        wake_when_done(future, queue.poke)
        until = timing.deadline(timeout_sec)
        timeout: Timeout = None if until is None or timeout_sec is None else TimeoutObject(timeout_sec)
        while self._context.ok() and not future.done() and not future.cancelled() and not queue.closed:
            self.spin_once_until_future_complete(future, timeout)
            if until is not None and isinstance(timeout, TimeoutObject):
                left = until - timing.monotonic_ns()
                if left <= 0:
                    return
                timeout.timeout = left / 1e9

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it; one thread at a time.

        :param timeout_sec: None or negative: no limit; 0: do not wait.
        :raises RuntimeError: if it spins already.
        """
        turn = self._turn
        try:
            turn.pop()
        except IndexError:
            raise RuntimeError(_ALREADY_SPINNING) from None
        try:
            self._spin_once_impl(timeout_sec)
        finally:
            turn.append(None)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: Timeout = None) -> None:
        """Do what `spin_once` does, but do not wait once the future is done."""
        wake_when_done(future, self._queue.poke)
        turn = self._turn
        try:
            turn.pop()
        except IndexError:
            raise RuntimeError(_ALREADY_SPINNING) from None
        try:
            self._spin_once_impl(timeout_sec, future.done)
        finally:
            turn.append(None)

    def _spin_once_impl(self, timeout_sec: Timeout = None, wait_condition: Condition = never) -> None:
        raise NotImplementedError

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Work:
        """Return the next (task, entity, node) to run: call the task.

        Arguments as `_wait_for_ready_callbacks`.

        The results of one wait are handed out before the next one; other arguments start again.
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
        condition: Condition = never,
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
        for item in self._search(timeout_sec, nodes, condition):
            yield self._runner.make_handler(item, self) if isinstance(item, Watch) else item

    def _search(
        self,
        timeout_sec: Timeout,
        nodes: list[Node] | None,
        condition: Condition,
        *,
        again: bool = False,
    ) -> Generator[Work | Watch, None, None]:
        """Do what `_wait_for_ready_callbacks` does, once or `again` and again, but make no handlers."""
        seconds = None
        while True:
            if timeout_sec is not None:
                seconds = timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
            end = yield from self._finder.find(seconds, nodes, condition, self.can_execute)
            if end is not None:
                if end is End.EXTERNAL_SHUTDOWN:
                    self._context._call_back()
                raise _EXCEPTIONS[end]
            if not again:
                return


_wait_for_ready_callbacks = Executor.wait_for_ready_callbacks  # not yet replaced by a derived class or a test


class SingleThreadedExecutor(Executor):
    """Runs callbacks on the thread that spins."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._work: Iterator[Work | Watch] | None = None  # where the search for work stands
        self._work_timeout: Timeout = None  # the arguments of that search
        self._work_condition = never

    def _spin_once_impl(self, timeout_sec: Timeout = None, wait_condition: Condition = never) -> None:
        if getattr(self.wait_for_ready_callbacks, "__func__", None) is not _wait_for_ready_callbacks:
            self._spin_once_by_handler(timeout_sec, wait_condition)
            return
        work = self._work
        if (
            work is None
            or self._work_timeout != timeout_sec
            or (self._work_condition is not wait_condition and self._work_condition != wait_condition)
        ):
            self._work_timeout, self._work_condition = timeout_sec, wait_condition
            work = self._work = self._search(timeout_sec, None, wait_condition, again=True)
        try:
            item = next(work)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            self._work = None
            return
        except BaseException:
            self._work = None
            raise
        if isinstance(item, Watch):
            if blocking.enabled:
                with blocking.inside_callback(self, item.entity):
                    self._runner.run(item, self)
            else:
                self._runner.run(item, self)
            return
        self._runner.run_task(item)

    def _spin_once_by_handler(self, timeout_sec: Timeout, wait_condition: Condition) -> None:
        """Ask `wait_for_ready_callbacks`, which a derived class or a test has put its own in place of."""
        try:
            work = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        self._runner.run_task(work)


class MultiThreadedExecutor(Executor):
    """Runs callbacks on a pool of threads. What a callback raises comes out of a later `spin_once`.

    :param num_threads: None: as many as there are CPUs for this process.
    :param context: None for the default one.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        from concurrent.futures import ThreadPoolExecutor  # late: it takes a tenth of the time to start

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

    def shutdown(self, timeout_sec: float | None = None, *, wait_for_threads: bool = True) -> bool:
        """Stop executing, and wait for callbacks that run.

        :param timeout_sec: accepted for upstream's sake.
        :param wait_for_threads: False: do not wait. A callback never waits for itself.
        :return: True.
        """
        super().shutdown(timeout_sec)
        is_callback = threading.current_thread() in self._executor._threads
        self._executor.shutdown(wait=wait_for_threads and not is_callback)
        return True

    def _spin_once_impl(self, timeout_sec: Timeout = None, wait_condition: Condition = never) -> None:
        try:
            work = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (ExternalShutdownException, ShutdownException, TimeoutException, ConditionReachedException):
            return
        try:
            self._executor.submit(self._runner.run_in_pool, work)
        except RuntimeError:
            if not self._queue.closed:
                raise
            return  # another thread has shut it down since
        if work[0] not in self._futures:
            self._futures.append(work[0])
        for future in self._futures[:]:
            if future.done():
                self._futures.remove(future)
                future.result()  # raises what the callback has raised
