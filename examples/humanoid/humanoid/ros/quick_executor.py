"""An executor for real rclpy that keeps up with 250 sensor readings a second.

rclpy's own executor gathers all entities of all nodes for each wait (subscriptions, parameter services, and
one or two events for each publisher and subscription), and waits twice for each batch of messages. With
three nodes that takes most of a millisecond for a message that is handled in a tenth of that time. This
executor waits for subscriptions alone. Every 20 ms, rclpy's own executor handles everything else.

It uses internals of rclpy as of Jazzy: `make` returns rclpy's own executor if rclpy is a different one, such
as ours.
"""

from __future__ import annotations

import inspect
import time
from contextlib import ExitStack
from importlib import import_module
from typing import Any

from rclpy.executors import Executor, ShutdownException, SingleThreadedExecutor, TimeoutException
from rclpy.subscription import Subscription

_LOOK = 0.02  # s between handling of everything
_NEEDED = ("_context", "_guard", "_is_shutdown", "_sigint_gc")


def make() -> Executor:
    """Return the quick executor if rclpy has what it needs, otherwise rclpy's own."""
    try:
        wait_sets = import_module("rclpy.impl.implementation_singleton").rclpy_implementation.WaitSet
    except (ImportError, AttributeError):
        return SingleThreadedExecutor()
    executor = _QuickExecutor(wait_sets)
    return executor if all(hasattr(executor, name) for name in _NEEDED) else SingleThreadedExecutor()


class _QuickExecutor(SingleThreadedExecutor):
    """Handles messages as they arrive, in one thread, and everything else a little later."""

    def __init__(self, wait_sets: Any) -> None:
        super().__init__()
        self._wait_sets = wait_sets
        # mypy sees our own rclpy, which has none of the internals that are used here.
        self._inside: Any = self
        self._looking = False  # whether rclpy handles everything except messages now

    def can_execute(self, entity: Any) -> bool:
        """Whether rclpy's own part handles an entity; it leaves messages to `_handle_messages`."""
        able: bool = super().can_execute(entity)
        return able and not (self._looking and isinstance(entity, Subscription) and _is_plain(entity))

    def spin(self) -> None:
        """Handle everything until the context or the executor is shut down."""
        while self._inside._context.ok() and not self._inside._is_shutdown:
            self._look_at_everything()
            self._handle_messages(time.monotonic() + _LOOK)

    def _look_at_everything(self) -> None:
        """Run rclpy's executor without waiting; it also continues coroutines."""
        self._looking = True
        try:
            while True:
                task, _, _ = self.wait_for_ready_callbacks(timeout_sec=0.0)
                task()
                if not task.done():
                    return
                task.result()
        except (TimeoutException, ShutdownException):
            pass
        finally:
            self._looking = False

    def _handle_messages(self, until: float) -> None:
        """Wait for messages only, until the given time or until something else needs attention."""
        inside = self._inside
        heard = (one for node in self.get_nodes() for one in node.subscriptions if _is_plain(one))
        subscriptions = [one for one in heard if self.can_execute(one)]
        guards = (inside._guard, inside._sigint_gc)
        with ExitStack() as stack:
            for entity in (*subscriptions, *guards):
                stack.enter_context(entity.handle)
            stack.enter_context(inside._context.handle)
            wait_set = self._wait_sets(len(subscriptions), len(guards), 0, 0, 0, 0, inside._context.handle)
            while (left := until - time.monotonic()) > 0 and inside._context.ok():
                wait_set.clear_entities()
                for subscription in subscriptions:
                    wait_set.add_subscription(subscription.handle)
                for guard in guards:
                    wait_set.add_guard_condition(guard.handle)
                wait_set.wait(int(left * 1e9))
                ready = set(wait_set.get_ready_entities("subscription"))
                # All are taken before any is handled, so that messages of one moment stay together.
                taken = [(one, _take(one)) for one in subscriptions if one.handle.pointer in ready]
                for subscription, arguments in taken:
                    if arguments:
                        subscription.callback(*arguments)
                if wait_set.get_ready_entities("guard_condition"):
                    return


def _is_plain(subscription: Subscription[Any]) -> bool:
    """Whether its callback is a plain function; coroutines are left to rclpy."""
    return not inspect.iscoroutinefunction(subscription.callback)


def _take(subscription: Any) -> tuple[Any, ...]:
    """The callback's arguments; nothing if another executor was faster."""
    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is None:
        return ()
    return tuple(taken[:1] if subscription._callback_type.name == "MessageOnly" else taken)
