"""Things that a session has declared, and the gate through which the threads of the program use it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Final
from weakref import WeakSet

import zenoh
from zenoh.handlers import Callback

from rmw_local.transports.interface import Receipt
from rmw_local.transports.zenoh import attachments

_MOST_TRIES: Final = 500
_BETWEEN_TRIES: Final = 0.001  # [s]
PATIENCE: Final = 2.0
"""Seconds that the end of a process waits for threads that are in Zenoh, or of Zenoh's."""


class Gate:
    """Lets threads into Zenoh, and Zenoh's threads into ours, until it is shut.

    A thread that comes back from Zenoh while Python ends is torn out of Zenoh's code, and that aborts the
    process; so is one of Zenoh's that calls Python, or lets go of what it called. So whoever ends waits until
    nobody is inside, and Zenoh holds no callback. Appending and popping are atomic: there is no lock.
    """

    def __init__(self) -> None:
        self._inside: list[None] = []
        self._callbacks: WeakSet[Any] = WeakSet()  # those that Zenoh holds, and nobody else
        self._is_shut = False

    def call(self, call: Callable[[], object]) -> None:
        """Do something that may fail because the session, or the other side, is gone meanwhile."""
        self._inside.append(None)
        try:
            if not self._is_shut:
                call()
        except (zenoh.ZError, RuntimeError):  # closed, or another thread is closing it
            return
        finally:
            self._inside.pop()

    def callback(self, function: Callable[..., object], *arguments: Any) -> Callback[Any]:
        """Returns what Zenoh calls as `function(*arguments, what_came)`.

        It does so on its own threads (`indirect=False`): a thread of Python for them would keep the
        interpreter from ending. The function may queue and wake, nothing else.
        """
        return self._held(partial(function, *arguments), None)

    def callback_with_end(self, function: Callable[..., object], end: Callable[[], None]) -> Callback[Any]:
        """The same; `end` is called when nothing more will come. Nobody else may keep `function`."""
        return self._held(function, end)

    def _held(self, function: Callable[..., object], end: Callable[[], None] | None) -> Callback[Any]:
        self._callbacks.add(function)
        return Callback(function, end, indirect=False)

    def shut(self) -> None:
        """Let nobody in any more."""
        self._is_shut = True

    def wait(self) -> None:
        """Wait until everybody has left, but not for ever. The session is closed."""
        end = time.monotonic() + PATIENCE
        while (self._inside or len(self._callbacks)) and time.monotonic() < end:
            time.sleep(_BETWEEN_TRIES)


class Presence:
    """A token, and what was declared before it. They go in the opposite order."""

    def __init__(self, gate: Gate, token: zenoh.LivelinessToken, gid: bytes, *declared: Any) -> None:
        self.gid = gid
        self._gate = gate
        self._parts = (token, *declared)

    def close(self) -> None:
        """Withdraw it."""
        for part in self._parts:
            self._gate.call(partial(_undeclare, part))


def _undeclare(part: Any) -> None:
    """Undeclare something, once no other thread sends by it any more."""
    for _ in range(_MOST_TRIES):
        try:
            part.undeclare()
        except RuntimeError:  # "Already borrowed"
            time.sleep(_BETWEEN_TRIES)
        else:
            return


class Publication(Presence):
    """A publisher that is announced."""

    def __init__(
        self,
        gate: Gate,
        token: zenoh.LivelinessToken,
        gid: bytes,
        publisher: Any,
        assert_alive: Callable[[], None],
        receipts: Callable[[str, float], list[Receipt] | None],
    ) -> None:
        super().__init__(gate, token, gid, publisher)
        self.receipts = receipts
        self.assert_alive = assert_alive
        self._publisher = publisher
        self._put = publisher.put
        self._shortcut: Callable[[bytes, bytes], bool] | None = None
        self._threshold = sys.maxsize  # [bytes]

    def shorten(self, shortcut: Callable[[bytes, bytes], bool], threshold: int) -> None:
        """Try another way first for messages of such a size [bytes] or more."""
        self._shortcut, self._threshold = shortcut, threshold

    def put(self, data: bytes, number: int, stamp: int) -> None:
        """Send a message."""
        attachment = attachments.pack(number, stamp, self.gid)
        if len(data) < self._threshold:
            self._gate.call(lambda: self._put(data, attachment=attachment))
        else:
            self._gate.call(lambda: self._put_large(data, attachment))

    def watch(self, on_listeners: Callable[[bool], None]) -> None:
        """Tell, once somebody listens in other processes, and when nobody does, also unannounced."""
        on_change: Any = self._gate.callback(lambda status: on_listeners(status.matching))
        if isinstance(self._publisher, zenoh.Publisher):  # others keep what they send, so they send always
            self._gate.call(lambda: self._publisher.declare_matching_listener(on_change))

    def _put_large(self, data: bytes, attachment: bytes) -> None:
        if self._shortcut is None or not self._shortcut(data, attachment):
            self._put(data, attachment=attachment)
