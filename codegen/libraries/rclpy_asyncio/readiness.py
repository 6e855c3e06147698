"""How a coroutine learns that something may be ready: listeners of our rclpy, or a thread in a wait set.

Our own rclpy says so itself. Real rclpy of Jazzy and Kilted can only be waited for, so that one thread
for each running node waits in a wait set for what the node's coroutines want, and for nothing else.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import Any, Protocol

import rclpy
from rclpy.client import Client
from rclpy.exceptions import InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.service import Service
from rclpy.signals import SignalHandlerGuardCondition
from rclpy.subscription import Subscription

_ADD: dict[Any, str] = {
    Subscription: "add_subscription",
    GuardCondition: "add_guard_condition",
    Client: "add_client",
    Service: "add_service",
}
_PLACES: tuple[Any, ...] = tuple(_ADD)
_rcl: Any = _rclpy
RCLError = _rclpy.RCLError


class Bell:
    """Wakes the one coroutine that waits for it; any thread may ring.

    Clear it, look, then wait: what rings after the look ends the wait at once.
    """

    __slots__ = ("_is_rung", "_loop", "_thread", "_waiter")

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._thread = threading.get_ident()
        self._is_rung = False
        self._waiter: asyncio.Future[None] | None = None

    def ring(self) -> None:
        """Wake the coroutine, or end its next wait."""
        if self._is_rung:
            return
        self._is_rung = True
        if threading.get_ident() == self._thread:
            self._wake()
        else:
            ring_later(self._loop, self._wake)

    def clear(self) -> None:
        """Forget what has rung."""
        self._is_rung = False

    def wait(self) -> asyncio.Future[None]:
        """Return what to await: the next ring, or nothing if it has rung since it was cleared."""
        self._waiter = waiter = self._loop.create_future()
        if self._is_rung:
            waiter.set_result(None)
        return waiter

    def _wake(self) -> None:
        if self._waiter is not None and not self._waiter.done():
            self._waiter.set_result(None)


def ring_later(loop: asyncio.AbstractEventLoop, callback: Callable[[], object]) -> None:
    """Call back in the loop's thread, unless the loop is closed: then nobody waits any more."""
    try:  # noqa: SIM105 - suppress() takes a tenth of the time of waking a loop
        loop.call_soon_threadsafe(callback)
    except RuntimeError:
        pass


class Sources(Protocol):
    """Rings the bells of those who wait for entities of one node."""

    def attach(self, entity: Any, bell: Bell) -> None:
        """Begin to watch an entity or a waitable."""

    def detach(self, entity: Any) -> None:
        """Watch it no more; nothing uses its handle afterwards."""

    def arm(self, entity: Any) -> None:
        """Ring once it is ready: its coroutine has found nothing and is going to wait."""

    def is_ready(self, waitable: Any) -> bool:
        """Ask a waitable whether it has something to take, a guard condition whether it was triggered."""
        ...

    async def until(self, is_true: Callable[[], bool], interval: float) -> None:
        """Wait until the graph makes something true; where nothing announces it, ask every `interval` [s]."""

    def close(self) -> None:
        """Watch nothing any more."""


def make_sources(
    node: Node,
    loop: asyncio.AbstractEventLoop,
    end: Callable[[], object],
    fail: Callable[[Exception], object],
) -> Sources:
    """Return what this rclpy offers.

    :param end: is called in the loop when a signal has ended the context.
    :param fail: is called in the loop if nothing can be waited for any more.
    """
    if hasattr(node.handle, "graph_node"):
        return _Listeners(node, loop, end)
    return _WaitSet(node, loop, end, fail)


class _Listeners:
    """The handles of our own rclpy call back themselves, on the thread that publishes."""

    def __init__(self, node: Node, loop: asyncio.AbstractEventLoop, end: Callable[[], object]) -> None:
        self._node = node
        self._loop = loop
        self._attached: dict[Any, tuple[Bell, tuple[Any, ...]]] = {}
        self._timed: dict[Any, list[Any]] = {}  # the handles that may become ready by themselves
        self._alarms: dict[Any, asyncio.TimerHandle] = {}
        self._signal = SignalHandlerGuardCondition(node.context)
        # A signal handler interrupts the loop's own thread, so that the selector has to be woken.
        self._signal.handle.add_listener(
            lambda: ring_later(loop, lambda: None if node.context.ok() else end())
        )

    def attach(self, entity: Any, bell: Bell) -> None:
        handles = (entity.handle,) if isinstance(entity, _PLACES) else self._handles_of(entity)
        self._attached[entity] = bell, handles
        if timed := [handle for handle in handles if handle.is_timed()]:
            self._timed[entity] = timed
        for handle in handles:
            handle.add_listener(bell.ring)

    def _handles_of(self, waitable: Any) -> tuple[Any, ...]:
        if waitable._fixed_handles:
            return tuple(waitable._fixed_handles)
        with waitable:  # a program has written it: only it knows
            wait_set = _rcl.WaitSet(*_numbers_of(waitable), self._node.context.handle)
            waitable.add_to_wait_set(wait_set)
            return tuple(wait_set.entities())

    def detach(self, entity: Any) -> None:
        bell, handles = self._attached.pop(entity, (None, ()))
        for handle in handles:
            handle.remove_listener(bell.ring if bell else None)
        self._timed.pop(entity, None)
        if (alarm := self._alarms.pop(entity, None)) is not None:
            alarm.cancel()

    def arm(self, entity: Any) -> None:
        if not self._timed or (timed := self._timed.get(entity)) is None:
            return
        if (alarm := self._alarms.pop(entity, None)) is not None:
            alarm.cancel()
        times = [at for handle in timed if (at := handle.wake_at()) is not None]
        if times:  # a goal expires
            self._alarms[entity] = self._loop.call_at(min(times) / 1e9, self._attached[entity][0].ring)

    def is_ready(self, waitable: Any) -> bool:
        if isinstance(waitable, GuardCondition):
            handle: Any = waitable.handle
            return bool(handle.take())
        if not waitable._fixed_handles:
            return _ask(waitable, self._node.context)
        ready: bool = waitable._find_ready()
        return ready

    async def until(self, is_true: Callable[[], bool], interval: float) -> None:
        bell = Bell(self._loop)
        handle: Any = self._node.handle
        changed = handle.graph_node.participant.domain.changed
        changed.add_listener(bell.ring)
        try:
            while True:
                bell.clear()
                if is_true():
                    return
                await bell.wait()
        finally:
            changed.remove_listener(bell.ring)

    def close(self) -> None:
        for entity in list(self._attached):
            self.detach(entity)
        self._signal.destroy()


class _WaitSet:
    """A thread waits in a wait set of real rclpy, and a guard condition tells it of changes."""

    def __init__(
        self,
        node: Node,
        loop: asyncio.AbstractEventLoop,
        end: Callable[[], object],
        fail: Callable[[Exception], object],
    ) -> None:
        self._context = node.context
        # Asked by the thread: the context itself holds a lock while its shutdown waits for the thread.
        self._handle = node.context.handle
        self._loop = loop
        self._end = end
        self._fail = fail
        self._bells: dict[Any, Bell] = {}
        self._armed: dict[Any, Bell] = {}
        self._triggered: set[Any] = set()  # guard conditions: the wait takes their trigger
        self._lock = threading.Lock()  # guards what is armed and whether this is closed
        self._is_closed = False
        self._guard = GuardCondition(None, None, context=node.context)
        self._signal = SignalHandlerGuardCondition(node.context)
        self._thread = threading.Thread(target=self._run, name=f"waits for {node.get_name()}", daemon=True)
        self._thread.start()

    def attach(self, entity: Any, bell: Bell) -> None:
        self._bells[entity] = bell

    def detach(self, entity: Any) -> None:
        self._bells.pop(entity, None)
        with self._lock:
            was_armed = self._armed.pop(entity, None)
        if was_armed:
            self._guard.trigger()

    def arm(self, entity: Any) -> None:
        with self._lock:
            self._armed[entity] = self._bells[entity]
        self._guard.trigger()

    def is_ready(self, waitable: Any) -> bool:
        if isinstance(waitable, GuardCondition):
            is_triggered = waitable in self._triggered
            self._triggered.discard(waitable)
            return is_triggered
        return _ask(waitable, self._context)

    async def until(self, is_true: Callable[[], bool], interval: float) -> None:
        # rclpy of Jazzy and Kilted keeps the graph's guard condition to itself; its own waits ask again, too.
        while not is_true():
            await asyncio.sleep(interval)

    def close(self) -> None:
        with self._lock:
            self._is_closed = True
            self._armed.clear()
        self._guard.trigger()
        self._thread.join()
        self._signal.destroy()
        self._guard.destroy()

    def _run(self) -> None:
        while True:
            with self._lock:
                if self._is_closed:
                    return
                armed = dict(self._armed)
            try:
                ready = self._wait(list(armed))
            except RuntimeError as error:
                if self._handle.ok():
                    ring_later(self._loop, partial(self._fail, error))
                    return
                ready = []
            if not self._handle.ok():
                ring_later(self._loop, self._end)
                return
            with self._lock:
                for entity in ready:
                    self._armed.pop(entity, None)
            self._triggered.update(each for each in ready if isinstance(each, GuardCondition))
            for entity in ready:
                armed[entity].ring()

    def _wait(self, armed: list[Any]) -> list[Any]:
        """Wait until some of these are ready, or for the guard condition; return those that are."""
        with ExitStack() as uses:
            uses.enter_context(self._context.handle)
            gone: list[Any] = []
            for entity in armed:
                try:
                    uses.enter_context(entity.handle if isinstance(entity, _PLACES) else entity)
                except InvalidHandle:  # its coroutine will notice, or is cancelled already
                    gone.append(entity)
            if gone:
                return gone
            places: dict[Any, list[Any]] = {
                kind: [e for e in armed if isinstance(e, kind)] for kind in _PLACES
            }
            others = [each for each in armed if not isinstance(each, _PLACES)]
            places[GuardCondition] += [self._guard, self._signal]
            counts = [len(each) for each in places.values()]
            wanted = [counts[0], counts[1], 0, counts[2], counts[3], 0]
            for waitable in others:
                wanted = [sum(each) for each in zip(wanted, _numbers_of(waitable), strict=True)]
            wait_set = _rcl.WaitSet(*wanted, self._context.handle)
            wait_set.clear_entities()
            for kind, entities in places.items():
                for entity in entities:
                    getattr(wait_set, _ADD[kind])(entity.handle)
            for waitable in others:
                waitable.add_to_wait_set(wait_set)
            wait_set.wait(-1)
            ready = [each for each in others if each.is_ready(wait_set)]
            for kind, entities in places.items():
                pointers = set(wait_set.get_ready_entities(_ADD[kind].removeprefix("add_")))
                ready += [e for e in entities if e.handle.pointer in pointers and e in armed]
            return ready


_NUMBERS = (
    "num_subscriptions",
    "num_guard_conditions",
    "num_timers",
    "num_clients",
    "num_services",
    "num_events",
)


def _numbers_of(waitable: Any) -> list[int]:
    numbers = waitable.get_num_entities()
    return [getattr(numbers, name) for name in _NUMBERS]


def _ask(waitable: Any, context: rclpy.Context) -> bool:
    """Ask a waitable by a wait set of its own, without waiting."""
    try:
        with waitable:
            wait_set = _rcl.WaitSet(*_numbers_of(waitable), context.handle)
            wait_set.clear_entities()
            waitable.add_to_wait_set(wait_set)
            wait_set.wait(0)
            ready: bool = waitable.is_ready(wait_set)
            return ready
    except InvalidHandle:
        return False
