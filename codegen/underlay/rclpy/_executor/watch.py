"""The record of an executor about each entity: whether it is ready, how to take, and how to call back.

A watch listens to the entity's handle. When the handle says that something may have happened, it sets the
mark of the watch, which goes into the executor's inbox: an idle entity costs an executor nothing. Handles of
the middleware stay in the graph and keep their listeners. So neither mark nor inbox keeps the watch, its
entity, its node or the executor alive: those become garbage when a program drops them.
"""

from __future__ import annotations

import inspect
import warnings
import weakref
from collections import deque
from collections.abc import Callable, Coroutine
from types import CoroutineType, GeneratorType
from typing import TYPE_CHECKING, Any, Protocol

from ifgen_runtime.errors import ServerGoneError
from rmw_local import timing
from rmw_local.ready import Listener

from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.rcl.topics import message_info
from rclpy.logging import get_logger

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.guard_condition import GuardCondition


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


RCLError = _rclpy.RCLError


class Source(Protocol):
    """The source that a watch listens to: a handle that is a ReadySource."""

    @property
    def pointer(self) -> int:
        """0 once it is destroyed."""

    def is_ready(self) -> bool:
        """Whether there is something to take."""

    def wake_at(self) -> int | None:
        """The time at which it becomes ready by itself [ns, steady]; None if it does not."""

    def remove_listener(self, listener: Listener) -> None:
        """Stop calling it."""


class Watch:
    """The watch of one entity; derived classes know the kinds, and the type of each kind's `source`."""

    __slots__ = (
        "__weakref__",
        "asked_always",
        "closed",
        "due",
        "entity",
        "listener",
        "mark",
        "node",
        "order",
        "source",
    )
    plural = ""  # what a node calls these
    asking_takes = False  # whether `is_ready` clears what it sees
    has_alarm = False  # whether it can become ready by itself

    def __init__(self, entity: Any, node: Any, inbox: Inbox) -> None:
        self.entity = entity
        self.node = node
        self.mark = Mark(self, inbox)
        self.order = 0  # position among all that is ready; the queue keeps it
        self.closed = False  # not watched any more
        self.asked_always = False  # the queue asks in every round, because nothing notifies reliably
        self.due: int | None = None  # the alarm [ns, steady] that the queue has for it
        self.listener: Callable[[], None] = self.mark.set
        self.source: Source = self.open()

    def open(self) -> Any:
        """Start to listen; returns the entity's handle."""
        handle = self.entity.handle
        handle.remove_listeners(tells_nobody)
        handle.add_listener(self.listener)
        return handle

    def close(self) -> None:
        """Stop listening."""
        self.closed = True
        self.source.remove_listener(self.listener)

    def is_ready(self) -> bool:
        """Whether there is something to take."""
        return self.source.is_ready()

    def is_destroyed(self) -> bool:
        """Whether the handle is gone, although the node does not know it yet."""
        return not self.source.pointer

    def wake_at(self) -> int | None:
        """The time at which it becomes ready by itself [ns, steady]; None if it does not."""
        return self.source.wake_at()

    def still_ready(self) -> bool:
        """Whether it is ready even now, after other callbacks of the round have run."""
        return True

    def take(self) -> Any:
        """Take what is there, so that the entity is no longer ready for it; None if there is nothing."""
        raise NotImplementedError

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Call back with what was taken; a coroutine if more remains to be done."""
        raise NotImplementedError


class TimerWatch(Watch):
    """Watches a timer."""

    __slots__ = ()
    source: _rclpy.Timer
    plural = "timers"
    has_alarm = True

    def still_ready(self) -> bool:
        """Whether it is still due: another callback may have cancelled the timer."""
        return self.is_ready()

    def take(self) -> Any:
        """Start the timer's next period; None if the handle is gone, or another thread has cancelled it."""
        if not self.source.pointer:
            return None
        try:
            return self.source.call_and_time()
        except RCLError:
            return None

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Call the timer's callback."""
        timer = self.entity
        callback = timer._callback
        if timer._info_parameter is None:
            return _unfinished(callback(), callback)
        distro.uses("TimerInfo")
        from rclpy.impl.newer import TimerInfo  # late: few programs use it

        info = TimerInfo(
            expected_call_time=taken[0], actual_call_time=taken[1], clock_type=timer.clock.clock_type
        )
        return _unfinished(callback(**{timer._info_parameter: info}), callback)


class SubscriptionWatch(Watch):
    """Watches a subscription."""

    __slots__ = ("_message_only",)
    source: _rclpy.Subscription
    plural = "subscriptions"

    def open(self) -> Any:
        """Look up the callback type once, and listen."""
        self._message_only = self.entity.CallbackType.MessageOnly  # an enum takes its time to find a member
        return super().open()

    def take(self) -> Any:
        """Take a message; None if the handle is gone."""
        try:
            return self.source.take(self.entity.raw)
        except RCLError:
            if self.source.pointer:
                raise
            return None

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Call the callback with the message, and with its metadata if it wants that."""
        subscription = self.entity
        callback = subscription._callback
        if subscription._callback_type is self._message_only:
            result = callback(taken[0])
        else:
            result = callback(taken[0], message_info(taken))
        return None if result is None else _unfinished(result, callback)


class GuardConditionWatch(Watch):
    """Watches a guard condition."""

    __slots__ = ()
    entity: GuardCondition
    source: _rclpy.GuardCondition
    plural = "guards"
    asking_takes = True

    def is_ready(self) -> bool:
        """Whether it was triggered, also if that was seen before and the callback has not yet run."""
        if self.source.take():
            self.entity._executor_triggered = True
        return self.still_ready()

    def still_ready(self) -> bool:
        """Whether the callback has not yet run since the trigger."""
        return self.entity._executor_triggered

    def take(self) -> Any:
        """Note that the trigger is handled."""
        self.entity._executor_triggered = False
        return True

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Call the callback of the guard condition."""
        callback: Any = self.entity.callback  # None only for guard conditions of executors themselves
        return _unfinished(callback(), callback)


class ClientWatch(Watch):
    """Watches a service client."""

    __slots__ = ()
    source: _rclpy.Client
    plural = "clients"

    def take(self) -> Any:
        """Take a response, or the failure of a request; None if the handle is gone."""
        try:
            header, response = self.source.take_response(self.entity.srv_type.Response)
            if header is None:
                header, response = self.source.take_failure()
        except RCLError:
            if self.source.pointer:
                raise
            return None
        return None if header is None else (header, response)

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Complete the future, unless the request was withdrawn."""
        header, response = taken
        try:
            future = self.entity.get_pending_request(header.request_id.sequence_number)
        except KeyError:
            return None
        future._set_executor(executor)
        if type(response) is ServerGoneError:
            future._fail(response)
        else:
            future.set_result(response)
        return None


class ServiceWatch(Watch):
    """Watches a service."""

    __slots__ = ()
    source: _rclpy.Service
    plural = "services"

    def take(self) -> Any:
        """Take a request; None if the handle is gone."""
        try:
            request, header = self.source.service_take_request(self.entity.srv_type.Request)
        except RCLError:
            if self.source.pointer:
                raise
            return None
        return None if header is None else (request, header)

    def call(self, taken: Any, executor: Executor) -> Coroutine[Any, Any, Any] | None:
        """Call the callback with the request, and send its response."""
        service = self.entity
        request, header = taken
        callback = service.callback
        try:
            result = callback(request, service.srv_type.Response())
            unfinished = _unfinished(result, callback)
            if unfinished is not None:
                return self._respond_later(unfinished, header)
            self._respond(result, header)
        except BaseException as error:
            self.source.fail(header.request_id, f"its callback has failed ({type(error).__name__})")
            raise
        return None

    def _respond(self, response: Any, header: Any) -> None:
        try:
            self.entity.send_response(response, header)
        except _rclpy.InvalidHandle:  # it was destroyed while its callback ran: its clients have been told
            service = self.source
            get_logger(service.get_logger_name()).warning(
                f"service '{service.name}' was destroyed during a request: the response goes to nobody"
            )

    async def _respond_later(self, unfinished: Coroutine[Any, Any, Any], header: Any) -> None:
        try:
            self._respond(await unfinished, header)
        except BaseException as error:
            self.source.fail(header.request_id, f"its callback has failed ({type(error).__name__})")
            raise


def _unfinished(result: Any, callback: Callable[..., Any]) -> Coroutine[Any, Any, Any] | None:
    """Return the coroutine that remains if the callback is a coroutine function.

    If a plain function happens to return a coroutine, nothing awaits it, as with the real rclpy.
    """
    if type(result) is CoroutineType and inspect.iscoroutinefunction(callback):
        return result
    if type(result) is GeneratorType:
        name = getattr(callback, "__qualname__", repr(callback))
        warnings.warn(f"nothing runs the generator function {name}: make it an `async def`", stacklevel=2)
    return None
