"""Callback groups: which callbacks may run at the same time."""

from __future__ import annotations

import weakref
from threading import Lock
from typing import Any


class CallbackGroup:
    """Decides when callbacks may run. Derive from it and implement the three methods below."""

    def __init__(self) -> None:
        super().__init__()
        self.entities: set[weakref.ref[Any]] = set()

    def add_entity(self, entity: Any) -> None:
        """Let the group decide about a subscription, timer, client, service, guard condition or waitable."""
        self.entities.add(weakref.ref(entity, self.entities.discard))  # the dead leave the set

    def has_entity(self, entity: Any) -> bool:
        """Return whether the group decides about it."""
        return weakref.ref(entity) in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Return whether its callback could run now."""
        raise NotImplementedError()

    def beginning_execution(self, entity: Any) -> bool:
        """Ask to run its callback; after True, `ending_execution` must follow."""
        raise NotImplementedError()

    def ending_execution(self, entity: Any) -> None:
        """Tell that its callback has run."""
        raise NotImplementedError()


class ReentrantCallbackGroup(CallbackGroup):
    """Callbacks run whenever there is a thread for them, also several of one entity."""

    def can_execute(self, entity: Any) -> bool:
        """Return True."""
        return True

    def beginning_execution(self, entity: Any) -> bool:
        """Return True."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Nothing to note."""


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """One callback at a time; a coroutine occupies the group until it returns."""

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Any = None
        self._occupied = Lock()  # held from the beginning to the end of an execution

    def can_execute(self, entity: Any) -> bool:
        """Return whether nothing of the group runs."""
        return self._active_entity is None

    def beginning_execution(self, entity: Any) -> bool:
        """Occupy the group, if it is free."""
        if not self._occupied.acquire(False):
            return False
        self._active_entity = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        """Free the group."""
        assert self._active_entity is entity
        self._active_entity = None
        self._occupied.release()
