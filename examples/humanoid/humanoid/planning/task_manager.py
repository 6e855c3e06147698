"""Decides what to do next: tasks one after another, with retries, and with interruptions from outside."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from ..simulation.battery import Level
from .tasks import Task

_STOPPED = "emergency stop"


@dataclass(frozen=True, slots=True)
class Order:
    """The task manager's present order: start a task, cancel the present one, or nothing."""

    start: Task | None = None
    cancel: bool = False


class TaskManager:
    """Hands out tasks. It is told how each ended, and the state of battery and emergency stop."""

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._waiting = deque(tasks)
        self._present: Task | None = None
        self._tries = 0
        self._cancelling = False
        self.number = 0  # of the present task, or of the last one
        self.done: list[tuple[Task, bool, str]] = []
        self.ended = ""  # why no more tasks will start, in words

    @property
    def idle(self) -> bool:
        """Whether no task is under way and none will start."""
        return self._present is None and (not self._waiting or bool(self.ended))

    @property
    def waiting(self) -> int:
        """The number of tasks that are still to come."""
        return len(self._waiting)

    @property
    def next(self) -> Task | None:
        """The task that comes next."""
        return self._waiting[0] if self._waiting else None

    def add(self, task: Task) -> None:
        """Add a task after those that already wait."""
        self._waiting.append(task)

    def forget(self) -> None:
        """Drop the tasks that wait."""
        self._waiting.clear()

    def finished(self, success: bool, message: str) -> bool:
        """Note that the present task has ended; returns whether it is tried again, as often as it says."""
        task = self._present
        if task is None:
            return False
        again = not success and self._tries < task.tries and not self.ended
        if again:
            self._waiting.appendleft(task)
        else:
            self.done.append((task, success, message))
            self._tries = 0
        self._present, self._cancelling = None, False
        return again

    def update(self, battery: Level = Level.NORMAL, stopped: bool = False) -> Order:
        """Return what to do now; a low battery ends the list after the present task, a critical one at once.

        So does a stop; tasks added after the stop are done.
        """
        if self.ended == _STOPPED:
            self.ended = ""
        if stopped:
            self._waiting.clear()  # tasks from before a stop are not done after it
            self.ended = _STOPPED
        elif battery is Level.CRITICAL:
            self.ended = "battery critical"
        elif battery is Level.LOW:
            self.ended = self.ended or "battery low"
        if self._present is not None:
            urgent = stopped or battery is Level.CRITICAL
            if urgent and not self._cancelling:
                self._cancelling = True
                return Order(cancel=True)
            return Order()
        if self.ended or not self._waiting:
            return Order()
        self._present = self._waiting.popleft()
        self.number += self._tries == 0
        self._tries += 1
        return Order(start=self._present)
