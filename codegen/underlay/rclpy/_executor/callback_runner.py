"""Running what the finder of an executor has found: as a task, or at once on this thread."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from threading import RLock
from typing import TYPE_CHECKING, Any

from rclpy._executor.ready_queue import ReadyQueue
from rclpy._executor.watch import Watch
from rclpy.task import Future, Task, _explained

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.executors import Executor
    from rclpy.node import Node


Work = tuple[Task, Any, "Node | None"]  # task, entity (None: created by a program), its node


class TaskList(list[Work]):
    """Tasks, oldest first. Any thread may add one; the thread that spins forgets those that are done."""

    def __init__(self) -> None:
        super().__init__()
        self._lock = RLock()  # reentrant: the garbage collector may end a future in here

    def add(self, task: Task, entity: Any, node: Node | None) -> Work:
        """Keep a task until it is done."""
        work = (task, entity, node)
        with self._lock:
            self.append(work)
        return work

    def forget_done(self) -> None:
        """Keep only those that are not done."""
        with self._lock:
            self[:] = [work for work in self if work[0]._pending()]

    def move_to_end(self, work: Work) -> None:
        """Let a task queue up after the others."""
        with self._lock:
            self.remove(work)
            self.append(work)


def run(task: Task) -> None:
    """Run a task and raise what it raises."""
    task()
    if task.exception() is not None:
        task.result()  # raises it


def run_in_pool(task: Task) -> None:
    """Run a task and keep the exception that ends it: a sys.exit on a thread of the pool would be lost."""
    try:
        task()
    except BaseException as error:
        task.set_exception(error)


def wake_when_done(future: Future, poke: Callable[[], None]) -> None:
    """Have a spinning thread woken when a future is done, by no task, which would outlive the wait."""
    if isinstance(future, Future):
        future._wake_when_done(poke)
    else:
        future.add_done_callback(lambda _: poke())


class CallbackRunner:
    """Runs callbacks on behalf of the executor of each call, which futures and tasks need.

    A callback group is occupied from before the taking of what is ready until the callback has returned.
    """

    only_group: CallbackGroup | None = None  # stands for the groups of all entities

    def __init__(self, queue: ReadyQueue, tasks: TaskList) -> None:
        self._queue = queue
        self._tasks = tasks

    def make_handler(self, watch: Watch, executor: Executor) -> Work:
        """Make the task that takes what is ready and calls back; until then the entity is not ready again."""
        watch.entity._executor_event = True
        task = Task(self._handle(watch, executor), executor=executor)
        task._entity = watch.entity
        return self._tasks.add(task, watch.entity, watch.node)

    async def _handle(self, watch: Watch, executor: Executor) -> None:
        entity = watch.entity
        group = entity.callback_group
        if self._queue.closed or not group.beginning_execution(entity):
            entity._executor_event = False
            self._queue.poke()
            return
        try:
            taken = watch.take()
            entity._executor_event = False
            self._queue.poke()
            if taken is None:
                self._queue.drop_if_destroyed(watch)
            else:
                unfinished = watch.call(taken, executor)
                if unfinished is not None:
                    await unfinished
        finally:
            group.ending_execution(entity)
            self._queue.poke()

    def run(self, watch: Watch, executor: Executor) -> None:
        """Take what is ready and call back on this thread, with no task unless a coroutine has to wait."""
        entity = watch.entity
        group = self.only_group or entity.callback_group
        if not group.beginning_execution(entity):
            return
        unfinished = None
        try:
            taken = watch.take()
            if taken is None:
                self._queue.drop_if_destroyed(watch)
            else:
                unfinished = watch.call(taken, executor)
        except RuntimeError as error:
            if (fault := _explained(error)) is not error:
                raise fault from error
            raise
        finally:
            if unfinished is None:
                group.ending_execution(entity)
        if unfinished is not None:
            coroutine = self._finish(unfinished, entity, group)
            try:
                awaited = coroutine.send(None)
            except StopIteration:
                return
            except RuntimeError as error:
                if (fault := _explained(error)) is not error:
                    raise fault from error
                raise
            task = Task(coroutine, executor=executor)
            task._entity = entity
            task._wait_for(awaited)
            self._tasks.add(task, entity, watch.node)
            task._wake_later()
        elif self._tasks:
            self._queue.poke()

    def run_task(self, work: Work) -> None:
        """Run a task on this thread, and raise what it raises."""
        run(work[0])

    def run_in_pool(self, work: Work) -> None:
        """Run a task on a thread of a pool, and keep what it raises."""
        task = work[0]
        run_in_pool(task)
        if task._exception is not None:
            # The thread that spins raises it, as soon as it has something to do.
            self._tasks.add(Task(_do_nothing), None, None)
            self._queue.poke()

    async def _finish(self, unfinished: Coroutine[Any, Any, Any], entity: Any, group: CallbackGroup) -> None:
        """Await the rest of a callback; its group stays occupied until then."""
        try:
            await unfinished
        finally:
            group.ending_execution(entity)
            self._queue.poke()


def _do_nothing() -> None:
    pass
