"""Futures and tasks."""

from __future__ import annotations

import inspect
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Coroutine, Generator, Mapping, Sequence
from enum import Enum
from typing import TYPE_CHECKING, Any

from rclpy.impl import blocking, typed
from rclpy.impl.typed import Generic, T

if TYPE_CHECKING:
    from rclpy.executors import Executor


class FutureState(Enum):
    """The state of a future."""

    PENDING = "PENDING"
    CANCELLED = "CANCELLED"
    FINISHED = "FINISHED"


_PENDING, _CANCELLED, _FINISHED = FutureState


class Future(Generic[T]):
    """A result that will be there later; `await` it in a coroutine that an executor runs.

    With an executor, done-callbacks become its tasks; without one they run at once on the thread that
    completes it.
    """

    def __init__(self, *, executor: Executor | None = None) -> None:
        self._state = _PENDING
        self._result: T | None = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[Callable[[Future[T]], object]] = []
        self._wakers: tuple[Callable[[], None], ...] = ()  # called on completion, before any done-callback
        self._lock = (
            threading.Lock()
        )  # guards the state and the callbacks; nothing is called while it is held
        self._executor_ref: weakref.ref[Executor] | None = None if executor is None else weakref.ref(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            print(f"The following exception was never retrieved: {self._exception}", file=sys.stderr)

    def __await__(self) -> Generator[Any, None, T]:
        while self._state is _PENDING:
            yield self  # the task that steps the coroutine waits for this
        if self._state is _CANCELLED:
            warnings.warn(
                "the future that is awaited was cancelled, so `await` returns None: ask `future.cancelled()`",
                stacklevel=2,
            )
        return self.result()

    def _pending(self) -> bool:
        return self._state is _PENDING

    def cancel(self) -> None:
        """Give up, unless it is done already."""
        with self._lock:
            if self._state is not _PENDING:
                return
            self._state = _CANCELLED
        self._call_back()

    def cancelled(self) -> bool:
        """Return whether it was given up."""
        return self._state is _CANCELLED

    def done(self) -> bool:
        """Return whether it has a result or an exception; False if it was given up."""
        return self._state is _FINISHED

    def result(self) -> T:
        """Return the result; raises the exception if there is one.

        None, whatever the type says, until it is done, or if it was cancelled.
        """
        if self._exception is not None:
            self._exception_fetched = True
            raise self._exception
        return self._result  # type: ignore[return-value]  # who asks too early gets None

    def exception(self) -> BaseException | None:
        """Return the exception; None if there is none."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: T) -> None:
        """Complete it."""
        with self._lock:
            self._result = result
            self._state = _FINISHED
        self._call_back()

    def set_exception(self, exception: BaseException) -> None:
        """Complete it with an exception. Nobody fetches it: it is printed when the future dies."""
        with self._lock:
            self._exception = exception
            self._exception_fetched = False
            self._state = _FINISHED
        self._call_back()

    def _fail(self, exception: BaseException) -> None:
        """Complete it with an exception that is not printed, whoever waits."""
        self.set_exception(exception)
        self._exception_fetched = True

    def add_done_callback(self, callback: Callable[[Future[T]], object]) -> None:
        """Call `callback(future)` when it is done or given up; at once if that has been."""
        with self._lock:
            if self._state is _PENDING:
                self._callbacks.append(callback)
                return
        executor = self._executor()
        if executor is None:
            callback(self)
        else:
            executor.create_task(callback, self)

    def remove_done_callback(self, callback: Callable[[Future[T]], object]) -> bool:
        """Take back `add_done_callback`; False if it is not there or too late."""
        with self._lock:
            try:
                self._callbacks.remove(callback)
            except ValueError:
                return False
            return True

    def _executor(self) -> Executor | None:
        return None if self._executor_ref is None else self._executor_ref()

    def _set_executor(self, executor: Executor | None) -> None:
        """Let this executor run the done-callbacks."""
        self._executor_ref = None if executor is None else weakref.ref(executor)

    def _wake_when_done(self, wake: Callable[[], None]) -> None:
        """Call `wake`, which only wakes a thread, when this is done; asking twice changes nothing."""
        if wake not in self._wakers:
            self._wakers = (*self._wakers, wake)
        if self._state is not _PENDING:
            wake()

    def _call_back(self) -> None:
        with self._lock:
            callbacks, self._callbacks = self._callbacks, []
            wakers, self._wakers = self._wakers, ()
        for wake in wakers:
            wake()
        if not callbacks:
            return
        executor = self._executor()
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:  # the other callbacks have to be called too
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)


def _explained(error: Exception) -> Exception:
    """The error that a callback has raised, with what to do where it looked for asyncio."""
    if type(error) is not RuntimeError or error.args != ("no running event loop",):
        return error
    explanation = RuntimeError(
        "no running event loop: an executor of rclpy runs this callback, not asyncio. Await futures of "
        "rclpy, which a timer may complete, or run asyncio on a thread of its own"
    )
    explanation.__cause__ = error
    return explanation


if TYPE_CHECKING:
    _FutureOf = Future
else:
    _FutureOf = typed.PlainBase(Future)


class Task(_FutureOf[T]):
    """A function or coroutine that an executor runs; made by `Executor.create_task`.

    Each call takes it one step on.

    :param handler: a function, a coroutine function, or a coroutine.
    :param args: for the handler.
    :param kwargs: for the handler.
    """

    def __init__(
        self,
        handler: Callable[..., Any] | Coroutine[Any, Any, Any],
        args: Sequence[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        executor: Executor | None = None,
    ) -> None:
        super().__init__(executor=executor)
        self._args = () if args is None else args
        self._kwargs = {} if kwargs is None else kwargs
        self._handler: Any = handler
        if inspect.iscoroutinefunction(handler):
            self._handler = handler(*self._args, **self._kwargs)
        self._entity: Any = None  # whose callback it runs; None: a program has created it
        self._executing = False
        self._awaited: Any = None  # the future that its coroutine waits for; None: it wants the next round
        self._task_lock = threading.Lock()  # held while it runs: no task runs twice at a time

    def __call__(self) -> None:
        """Run the function, or the coroutine up to its next `await` that has to wait."""
        if self._state is not _PENDING or not self._task_lock.acquire(blocking=False):
            return
        try:
            if self._state is _PENDING:
                self._executing = True
                if blocking.enabled:
                    with blocking.inside_callback(self._executor(), self._entity):
                        self._step()
                else:
                    self._step()
                self._executing = False
        finally:
            self._task_lock.release()
        if self._state is _PENDING:
            self._wake_later()

    def _wake_later(self) -> None:
        """Wake the executor when the coroutine can go on. The caller does not run it any more."""
        executor = self._executor()
        if executor is not None:
            poke = executor._queue.poke
            if self._awaited is None:
                poke()
            else:
                self._awaited._wake_when_done(poke)

    def _can_step(self) -> bool:
        """Whether a call takes it on: it is not done, nobody runs it, and what it awaits is not pending."""
        if self._state is not _PENDING or self._executing:
            return False
        return self._awaited is None or not self._awaited._pending()

    def _step(self) -> None:
        try:
            if inspect.iscoroutine(self._handler):
                self._wait_for(self._handler.send(None))
                return
            result = self._handler(*self._args, **self._kwargs)
        except StopIteration as end:
            self._handler = None
            self.set_result(end.value)
        except Exception as error:
            self._handler = None
            self.set_exception(_explained(error))
        else:
            self._handler = None
            self.set_result(result)

    def _wait_for(self, awaited: Any) -> None:
        """Note what the coroutine has stopped for: a future, or something that only another step can tell."""
        self._awaited = awaited if isinstance(awaited, Future) else None

    def executing(self) -> bool:
        """Return whether it is running right now."""
        return self._executing

    def cancel(self) -> None:
        """Give up, unless it is done; a coroutine is closed."""
        if self._state is _PENDING and inspect.iscoroutine(self._handler):
            self._handler.close()
        super().cancel()
