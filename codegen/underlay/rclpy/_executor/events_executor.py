"""The class behind `rclpy.experimental.EventsExecutor`."""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from rclpy._executor.callback_runner import CallbackRunner, Work
from rclpy._executor.watch import Watch
from rclpy._executor.work_finder import Condition, Find, MayExecute, WorkFinder, never
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor, Timeout
from rclpy.impl import distro
from rclpy.task import Future

if TYPE_CHECKING:
    from rclpy.node import Node


class EventsExecutor(SingleThreadedExecutor):
    """Runs callbacks in the order in which they became due, but tasks before them, oldest first.

    A task that has had its turn and still waits queues up after the other tasks and the next callback.
    Callback groups are ignored, as by the real one: callbacks alternate only where coroutines wait.
    `spin_once` always runs something if it can, also with timeout 0. An exception of a callback is logged and
    raised from spin.
    """

    def __init__(self, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._queue.in_order_of_notes = True
        self._finder = OrderedFinder(self._context, self._queue, self._tasks, self._nodes)
        self._runner = LoggingRunner(self._queue, self._tasks)

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Spin as an Executor does; also runs what is ready when the time is over."""
        super().spin_until_future_complete(future, timeout_sec)
        while self._context.ok() and not future.done() and not self._is_shutdown:
            if not self._finder.wait(None, None, self.can_execute, poll=True):
                return
            self.spin_once(timeout_sec=0)

    def can_execute(self, entity: Any) -> bool:
        """Return whether no handler of an entity is on its way."""
        return not entity._executor_event

    def _spin_once_impl(self, timeout_sec: Timeout = None, wait_condition: Condition = never) -> None:
        self._work = None  # look for what is first now, not for what was second at the last wait
        super()._spin_once_impl(timeout_sec, wait_condition)


class OrderedFinder(WorkFinder):
    """Finds tasks oldest first, and lets one that has had its turn queue up."""

    _resumed: Work | None = None  # the task that ran last, if nothing else has run since

    def find(
        self,
        timeout_sec: float | None,
        nodes: list[Node] | None,
        condition: Condition,
        may_execute: MayExecute,
    ) -> Find:
        """Resume the last task first, then look as a WorkFinder does."""
        resumed, self._resumed = self._resumed, None
        if resumed is not None and resumed[0]._pending():
            self._tasks.move_to_end(resumed)
            yield from self.wait(None, nodes, may_execute, poll=True) or ()
        return (yield from super().find(timeout_sec, nodes, condition, may_execute))

    def _runnable_tasks(self, nodes: list[Node] | None) -> Iterator[Work]:
        tasks = list(super()._runnable_tasks(nodes))
        if not distro.follows("task_order"):
            tasks.reverse()
        for self._resumed in tasks:
            yield self._resumed


class LoggingRunner(CallbackRunner):
    """Runs callbacks whatever their groups say; logs what they raise."""

    only_group = ReentrantCallbackGroup()

    def run(self, watch: Watch, executor: Executor) -> None:
        """Run a callback or a task of this round."""
        self._queue.move_to_end(watch)
        try:
            super().run(watch, executor)
        except Exception as error:
            logger = watch.node.get_logger()
            logger.fatal(f"Exception in '{watch.plural}' callback: {error}")
            logger.warn("Error occurred at:\n" + "".join(traceback.format_tb(error.__traceback__)[-1:]))
            raise
