"""The way of a handle to an executor: it sets a mark, and the mark goes into the executor's inbox.

Handles of the middleware stay in the graph and keep their listeners. So neither mark nor inbox keeps the
watch, its entity, its node or the executor alive: those become garbage when a program drops them.
"""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

from rmw_local import timing

if TYPE_CHECKING:
    from rclpy._executor.watch import Watch


class Inbox:
    """Marks that were set and not yet looked at, and whether somebody asks for the end of the wait.

    There is no lock: a deque takes marks, and the order "note, then look whether the executor sleeps" there
    and "say that it sleeps, then look for notes" here leaves no gap.
    """

    __slots__ = ("notes", "poked", "sleeping", "waker")

    def __init__(self) -> None:
        self.notes: deque[Mark] = deque()
        self.poked = False
        self.sleeping = False
        self.waker = timing.make_waker(lasting=True)

    def note(self, mark: Mark) -> None:
        """Keep a mark for the executor, and wake it; any thread, also from a signal handler."""
        self.notes.append(mark)
        if self.sleeping:
            self.waker.wake()

    def poke(self) -> None:
        """End the present wait, or the next one; any thread, also from a signal handler."""
        self.poked = True
        if self.sleeping:
            self.waker.wake()

    def sleep(self, until: int | None) -> None:
        """Sleep until there is a note or a poke, or a steady time [ns] is reached."""
        self.sleeping = True
        try:
            if not self.notes and not self.poked:
                timing.wait(self.waker, until)
        finally:
            self.sleeping = False


class Mark:
    """Says once that the entity of a watch may be ready, until somebody has looked."""

    __slots__ = ("inbox", "is_set", "watch")

    def __init__(self, watch: Watch, inbox: Inbox) -> None:
        self.watch = weakref.ref(watch)
        self.inbox = inbox
        self.is_set = False

    def set(self) -> None:
        """Listen to a handle; any thread, also from a signal handler."""
        if not self.is_set:
            self.is_set = True
            self.inbox.note(self)


def tells_nobody(listener: Callable[[], None]) -> bool:
    """Whether a listener is a mark whose watch is gone."""
    mark = getattr(listener, "__self__", None)
    return isinstance(mark, Mark) and mark.watch() is None
