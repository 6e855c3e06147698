"""How an executor runs what its ready queue has found: as a task, or at once on this thread."""

from __future__ import annotations

from collections.abc import Coroutine
from threading import RLock
from typing import TYPE_CHECKING, Any

from rclpy._executor.ready_queue import ReadyQueue
from rclpy._executor.watch import Watch
from rclpy.task import Task

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.executors import Executor
    from rclpy.node import Node

Work = tuple[Task, Any, "Node | None"]  # task, entity (None: created by a program), its node


class CallbackRunner:
    """The part of an executor that runs callbacks and keeps tasks.

    A callback group is occupied from before the taking of what is ready until the callback has returned.
    """

    _queue: ReadyQueue
    _is_shutdown: bool
    _only_group: CallbackGroup | None = None  # stands for the groups of all entities

    def __init__(self) -> None:
        super().__init__()
        self._tasks: list[Work] = []  # oldest first
        self._tasks_lock = RLock()  # reentrant: the garbage collector may end a future in here

    def _add_task(self, task: Task, entity: Any, node: Node | None) -> None:
        with self._tasks_lock:
            self._tasks.append((task, entity, node))
        self._queue.poke()

    def _make_handler(self, watch: Watch) -> Work:
        """Make the task that takes what is ready and calls back; until then the entity is not ready again."""
        watch.entity._executor_event = True
        task = Task(self._handle(watch), executor=self._as_executor())
        task._entity = watch.entity
        with self._tasks_lock:
            self._tasks.append((task, watch.entity, watch.node))
        return task, watch.entity, watch.node

    async def _handle(self, watch: Watch) -> None:
        entity = watch.entity
        group = entity.callback_group
        if self._is_shutdown or not group.beginning_execution(entity):
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
                unfinished = watch.call(taken, self._as_executor())
                if unfinished is not None:
                    await unfinished
        finally:
            group.ending_execution(entity)
            self._queue.poke()

    def _run(self, watch: Watch) -> None:
        """Take what is ready and call back on this thread, with no task unless a coroutine has to wait."""
        entity = watch.entity
        group = self._only_group or entity.callback_group
        if not group.beginning_execution(entity):
            return
        unfinished = None
        try:
            taken = watch.take()
            if taken is None:
                self._queue.drop_if_destroyed(watch)
            else:
                unfinished = watch.call(taken, self._as_executor())
        finally:
            if unfinished is None:
                group.ending_execution(entity)
        if unfinished is not None:
            coroutine = self._finish(unfinished, entity, group)
            try:
                coroutine.send(None)
            except StopIteration:
                return
            task = Task(coroutine, executor=self._as_executor())
            task._entity = entity
            self._add_task(task, entity, watch.node)
        elif self._tasks:
            self._queue.poke()

    async def _finish(self, unfinished: Coroutine[Any, Any, Any], entity: Any, group: CallbackGroup) -> None:
        """Await the rest of a callback; its group stays occupied until then."""
        try:
            await unfinished
        finally:
            group.ending_execution(entity)
            self._queue.poke()

    def _as_executor(self) -> Executor:
        return self  # type: ignore[return-value]  # every runner is one; a cast() would take time for each message
