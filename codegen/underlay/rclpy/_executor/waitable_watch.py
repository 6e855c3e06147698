"""Watches of waitables: those of users are asked in every round, rclpy's own when something happened."""

from __future__ import annotations

from collections.abc import Coroutine, Sequence
from typing import TYPE_CHECKING, Any

from rclpy._executor.watch import Watch, tells_nobody
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rmw_local.ready import ReadySource

    from rclpy.executors import Executor
    from rclpy.waitable import Waitable


class WaitableWatch(Watch):
    """Watches a waitable of the user: asks it in every round, with its own wait set.

    It may add other handles each time. The watch listens to those of the last round.
    """

    __slots__ = ("_found", "_listened_to", "_timed")
    entity: Waitable
    plural = "waitables"
    asking_takes = True
    has_alarm = True

    def open(self) -> Any:
        """Start without sources, and ask in every round."""
        self._listened_to: Sequence[ReadySource] = []
        self._timed: list[ReadySource] = []  # those of them that may become ready by themselves
        self._found = False  # found ready, and not yet taken
        self.asked_always = True
        return None

    def close(self) -> None:
        """Stop listening."""
        self.closed = True
        self._listen_to([])

    def is_destroyed(self) -> bool:
        """Return False: a waitable itself reports that it is not ready."""
        return False

    def is_ready(self) -> bool:
        """Whether it was found ready, now or before."""
        if not self._found:
            self._found = self._ask()
        return self._found

    def _ask(self) -> bool:
        waitable = self.entity
        context = self.node.context.handle
        try:
            with waitable:
                count = waitable.get_num_entities()
                wait_set = _rclpy.WaitSet(
                    count.num_subscriptions,
                    count.num_guard_conditions,
                    count.num_timers,
                    count.num_clients,
                    count.num_services,
                    count.num_events,
                    context,
                )
                waitable.add_to_wait_set(wait_set)
                sources = wait_set.entities()
                self._listen_to(sources)
                if sources:
                    wait_set.wait(0)
                return waitable.is_ready(wait_set)
        except _rclpy.InvalidHandle:
            return False

    def wake_at(self) -> int | None:
        """The earliest time at which a source becomes ready by itself [ns, steady]; None if none does."""
        if not self._timed:
            return None
        return min((at for source in self._timed if (at := source.wake_at()) is not None), default=None)

    def take(self) -> Any:
        """Take the waitable's data, in a tuple, because None is data here."""
        self._found = False
        return (self.entity.take_data(),)

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Execute the waitable with its data."""
        for future in self.entity._futures:
            future._set_executor(executor)
        return self.entity.execute(taken[0])

    def _listen_to(self, sources: Sequence[ReadySource]) -> None:
        if sources == self._listened_to:
            return
        for source in self._listened_to:
            source.remove_listener(self.listener)
        for source in sources:
            source.remove_listeners(tells_nobody)
            source.add_listener(self.listener)
        self._listened_to = sources
        self._timed = [source for source in sources if source.is_timed()]


class FixedWaitableWatch(WaitableWatch):
    """Watches a waitable of rclpy, which always waits for the same handles."""

    __slots__ = ()

    def open(self) -> Any:
        """Listen to its fixed sources."""
        self._listened_to = []
        self._found = False
        self._listen_to(list(self.entity._fixed_handles))
        return None

    def _ask(self) -> bool:
        return self.entity._find_ready()
