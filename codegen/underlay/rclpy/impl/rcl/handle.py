"""Handles live until their destruction is requested and nothing uses them any more; and what they raise."""

from __future__ import annotations

import builtins
import os
import threading
from types import TracebackType
from typing import Any, SupportsIndex


class RCLError(RuntimeError):
    """An operation of the client library failed."""


class RMWError(RuntimeError):
    """An operation of the middleware failed."""


class RCUtilsError(RuntimeError):
    """A helper below the client library failed."""


class InvalidHandle(RuntimeError):
    """An entity was used after its destruction had been requested."""


class NodeNameNonExistentError(RCLError):
    """A graph query named a node that does not exist."""


class UnsupportedEventTypeError(RCLError):
    """The middleware does not know this kind of QoS event."""


class RCLInvalidROSArgsError(RCLError):
    """The ROS arguments could not be parsed."""


class UnknownROSArgsError(RuntimeError):
    """There are unknown ROS arguments; its text is their list."""


class TimerCancelledError(RCLError):
    """A timer was called that is stopped."""


class NotImplementedError(builtins.NotImplementedError):
    """Upstream's extension has a separate class for this."""


# The end of several messages: rcl says it wherever an entity would be made in a context that is not up.
CONTEXT_NOT_VALID = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
)


# Taken for an instant when a handle goes; nothing is called while it is held, so it orders with no other
# lock.
_ending = threading.Lock()


def as_bool(value: object, name: str) -> bool:
    """A flag as the extension module takes it: an object with `__bool__`; TypeError for the rest."""
    if value is None or hasattr(value, "__bool__"):
        return bool(value)
    raise TypeError(f"{name} is a bool, not {type(value).__name__}")


class Unpicklable:
    """Refuses pickling as upstream's extension module does, so that a program that works here works there."""

    __slots__ = ()

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[Any, ...]:
        kind = type(self)
        raise TypeError(f"cannot pickle '{kind.__module__}.{kind.__qualname__}' object")


class Destroyable(Unpicklable):
    """Something of the client library that is used inside `with handle:` and destroyed once.

    The count of users is a list, because append and pop are atomic: the order "enter, then look at the flag"
    here and "set the flag, then look at the users" there leaves no gap between a user and a destroyer, with
    no lock per use.
    """

    def __init__(self) -> None:
        self._users: list[None] = []
        self._destruction_requested = False
        self._destroyed = False

    def __enter__(self) -> None:
        self._users.append(None)
        if self._destruction_requested:
            self.__exit__(None, None, None)
            self.refuse_if_destroyed()

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        if not self._users:
            raise RuntimeError("Internal error: Destroyable use_count would be negative")
        self._users.pop()
        if self._destruction_requested:
            self._destroy_if_unused()

    def destroy_when_not_in_use(self) -> None:
        """Destroy it now, or when the last user leaves its `with` block; asking again changes nothing."""
        self._destruction_requested = True
        self._destroy_if_unused()

    def refuse_if_destroyed(self) -> None:
        """Raise InvalidHandle after destruction was requested, for callers without a `with` block.

        They ask before they use the handle, and once more if that has failed: another thread may have
        destroyed it meanwhile.
        """
        if self._destruction_requested:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")

    @property
    def pointer(self) -> int:
        """A number that identifies the living object; 0 once it is destroyed."""
        return 0 if self._destroyed else id(self)

    def _destroy_if_unused(self) -> None:
        with _ending:
            if self._users or self._destroyed:
                return
            self._destroyed = True
        self._on_destroy()

    def _on_destroy(self) -> None:
        """Release what the handle holds; runs exactly once, with no lock held."""


def _renew_lock() -> None:
    global _ending  # noqa: PLW0603 - a thread that does not exist in the fork may have held the other one
    _ending = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_lock)
