"""The tasks of an executor: those that programs created, and callbacks that wait."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import TYPE_CHECKING, Any

from rclpy.task import Future, Task

if TYPE_CHECKING:
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
