"""The ready queue of an executor: which of its entities have something to do, without asking the idle ones.

What other threads and signal handlers say comes through the inbox; everything else here belongs to the thread
that spins, unless it says "any thread". Waitables of users are asked in every round, rclpy's own when
something happened.
"""

from __future__ import annotations

import heapq
import itertools
from collections import deque
from collections.abc import Callable, Coroutine, Iterable, Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from rmw_local import timing

from rclpy._executor.watch import (
    ClientWatch,
    GuardConditionWatch,
    Inbox,
    ServiceWatch,
    SubscriptionWatch,
    TimerWatch,
    Watch,
    tells_nobody,
)
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


_by_order = attrgetter("order")

# The order within a node; waitables of all nodes come before.
_KINDS: tuple[type[Watch], ...] = (
    TimerWatch,
    SubscriptionWatch,
    GuardConditionWatch,
    ClientWatch,
    ServiceWatch,
)


class ReadyQueue:
    """Watches the entities of nodes for one executor."""

    def __init__(self) -> None:
        self.in_order_of_notes = False  # else: in the order of nodes and kinds
        self.stale = True  # nodes or entities have come or gone since the last `watch`
        self.closed = False  # the executor was shut down
        self._watches: dict[int, Watch] = {}  # by the id of the entity
        # Those to be asked in every round until they say no; a set with order.
        self._candidates: dict[Watch, None] = {}
        self._destroyed: deque[Watch] = deque()  # no longer candidates, as soon as the queue looks
        self._alarms: list[tuple[int, int, Watch]] = []  # heap of (steady time [ns], number, watch)
        self._alarm_numbers = itertools.count()
        self.has_slept = False  # set by `sleep`, cleared by the one who asks
        self.inbox = Inbox()
        self.poke = self.inbox.poke

    def watch(self, nodes: Iterable[Any]) -> None:
        """Watch all entities of these nodes and nothing else."""
        self.stale = False
        known, self._watches = self._watches, {}
        nodes = list(nodes)
        for node in nodes:
            for waitable in node.waitables:
                fixed = bool(waitable._fixed_handles)
                self._keep(known, waitable, node, FixedWaitableWatch if fixed else WaitableWatch)
        for node in nodes:
            for watch_class in _KINDS:
                for entity in getattr(node, watch_class.plural):
                    self._keep(known, entity, node, watch_class)
        for watch in known.values():
            watch.close()
            self._candidates.pop(watch, None)
        if any(watch.due is not None for watch in known.values()):
            # An unneeded alarm would keep the node until it rings.
            self._alarms = [alarm for alarm in self._alarms if not alarm[2].closed]
            heapq.heapify(self._alarms)

    def close(self) -> None:
        """Let the executor find nothing any more, and end its wait; any thread."""
        self.closed = True
        self.poke()

    def collect(self, may_execute: Callable[[Any], bool], nodes: Iterable[Any] | None) -> list[Watch]:
        """Return what is ready and may be executed, in the order in which it is due.

        :param nodes: only entities of these; None: all.
        """
        candidates, notes = self._candidates, self.inbox.notes
        while notes:
            mark = notes.popleft()
            mark.is_set = False
            noted = mark.watch()
            if noted is not None and not noted.closed:
                candidates[noted] = None
        while self._destroyed:
            candidates.pop(self._destroyed.popleft(), None)
        if self._alarms and self._alarms[0][0] <= timing.monotonic_ns():
            self._ring()
        if not candidates:
            return []
        ready = []
        # A new set each time: iterating over a set stays slow after many deletions.
        asked_again: dict[Watch, None] = {}
        for watch in candidates:
            asked_again[watch] = None
            if nodes is not None and watch.node not in nodes:
                continue
            # To ask some clears what they wait for, so they are asked only if they may be executed.
            if watch.asking_takes and not may_execute(watch.entity):
                continue
            if not watch.is_ready():
                self._set_alarm(watch)
                if not watch.asked_always:
                    del asked_again[watch]
            elif watch.asking_takes or may_execute(watch.entity):
                ready.append(watch)
        self._candidates = asked_again
        if len(ready) > 1 and not self.in_order_of_notes:
            ready.sort(key=_by_order)
        return ready

    def drop_if_destroyed(self, watch: Watch) -> None:
        """Do not ask an entity again if its handle is gone, so that nothing could be taken; any thread."""
        if watch.is_destroyed():
            self._destroyed.append(watch)

    def move_to_end(self, watch: Watch) -> None:
        """Let an entity that has more to do queue up after the others."""
        if self._candidates.pop(watch, self) is None:
            self._candidates[watch] = None

    def sleep(self, until: int | None) -> None:
        """Sleep until something is noted or poked, an alarm is due, or a steady time [ns] is reached."""
        if self._alarms:
            alarm = self._alarms[0][0]
            until = alarm if until is None or alarm < until else until
        self.has_slept = True
        self.inbox.sleep(until)

    def _keep(self, known: dict[int, Watch], entity: Any, node: Any, watch_class: type[Watch]) -> None:
        watch = known.pop(id(entity), None)
        if watch is None:
            watch = watch_class(entity, node, self.inbox)
            watch.mark.set()
        watch.node = node
        watch.order = len(self._watches)
        self._watches[id(entity)] = watch

    def _ring(self) -> None:
        """Make candidates of those whose alarm is due."""
        alarms, now = self._alarms, timing.monotonic_ns()
        while alarms and alarms[0][0] <= now:
            at, _, watch = heapq.heappop(alarms)
            if watch.due == at and not watch.closed:
                watch.due = None
                self._candidates[watch] = None

    def _set_alarm(self, watch: Watch) -> None:
        """Remember when an entity that is not ready becomes so by itself."""
        if watch.has_alarm and (at := watch.wake_at()) is not None and (watch.due is None or at < watch.due):
            # An alarm that is later than an existing one is not set: the existing one rings first, and leads
            # here again.
            watch.due = at
            heapq.heappush(self._alarms, (at, next(self._alarm_numbers), watch))
