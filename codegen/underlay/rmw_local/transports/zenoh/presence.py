"""Things that a session has declared, and the gate through which the threads of the program use it.

Private sessions may have very many publishers, subscribers and tokens. Zenoh compares each one that is
declared with all that are there, in each process: 4,000 topics took a process 8 to 15 s. Beyond the first
ones, subscriptions share one subscriber to all topics of the domain, publishers send by key, and tokens get
keys that have less in common. Such a process gets messages that nobody in it wants, and publishers there do
not notice who listens without being announced. Sessions that are not private go by rmw_zenoh's conventions
in everything: routers, their access control and other implementations know no others.
"""

from __future__ import annotations

import _thread
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count
from typing import Any, Final
from weakref import WeakSet

import zenoh
from zenoh import Locality
from zenoh.handlers import Callback

from rmw_local.transports.interface import Receipt
from rmw_local.transports.zenoh import attachments, tokens

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


_MOST: Final = 250
"""The number of publishers, of subscriptions and of tokens that are declared as everywhere.

Of publishers and tokens, it counts those that are gone, too.
"""

Handler = Callable[[zenoh.Sample], object]


class Crowds:
    """The endpoints of one session, and their tokens."""

    def __init__(self, session: zenoh.Session, gate: Gate, domain: int, *, is_private: bool) -> None:
        self._session = session
        self._is_private = is_private
        self._gate = gate
        self._everything = f"{domain}/**"
        self._publishers, self._tokens = count(1), count(1)
        self._subscribers = 0  # those that are there, with keys of their own
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._hearing: dict[str, tuple[Handler, ...]] = {}  # by key; what shares a subscriber
        self._shared: object = None

    def token(self, text: str) -> zenoh.LivelinessToken:
        """Declare a token, with its own key or another one."""
        is_one_of_many = self._is_one_of_many(self._tokens)
        return self._session.liveliness().declare_token(tokens.in_crowd(text) if is_one_of_many else text)

    def publisher(self, key: str, **options: Any) -> Any:
        """Declare a publisher, or return what sends by key."""
        if self._is_one_of_many(self._publishers):
            return _ByKey(self._session, key, **options)
        return self._session.declare_publisher(key, **options)

    def subscriber(self, key: str, handler: Handler) -> Any:
        """Call a handler with what comes by a key."""
        with self._lock:
            if not self._is_private or self._subscribers < _MOST:
                self._subscribers += 1
                return _Own(self, self._declare(key, handler))
            self._hearing[key] = (*self._hearing.get(key, ()), handler)
            if self._shared is None:
                self._shared = self._declare(self._everything, self._on_sample)
        return _Shared(self, key, handler)

    def _is_one_of_many(self, numbers: Iterator[int]) -> bool:
        return self._is_private and next(numbers) > _MOST

    def _declare(self, key: str, handler: Handler) -> Any:
        return self._session.declare_subscriber(
            key, self._gate.callback(handler), allowed_origin=Locality.REMOTE
        )

    def leave(self) -> None:
        """Have one subscriber less."""
        with self._lock:
            self._subscribers -= 1

    def leave_others(self, key: str, handler: Handler) -> None:
        """Call a handler no longer."""
        with self._lock:
            left = tuple(each for each in self._hearing.get(key, ()) if each is not handler)
            if left:
                self._hearing[key] = left
            else:
                self._hearing.pop(key, None)

    def _on_sample(self, sample: zenoh.Sample) -> None:
        for handler in self._hearing.get(str(sample.key_expr), ()):
            handler(sample)


class _ByKey:
    """A publisher that is not declared."""

    def __init__(self, session: zenoh.Session, key: str, **options: Any) -> None:
        del options["reliability"]  # Unix sockets are reliable
        self.put = partial(session.put, key, **options)

    def undeclare(self) -> None:
        """Do nothing."""


class _Own:
    """A subscription with a subscriber of its own."""

    def __init__(self, crowds: Crowds, subscriber: Any) -> None:
        self._crowds, self._subscriber = crowds, subscriber

    def undeclare(self) -> None:
        """Undeclare it; raises RuntimeError if that has to be tried again."""
        self._subscriber.undeclare()
        self._crowds.leave()


class _Shared:
    """A subscription that shares a subscriber."""

    def __init__(self, crowds: Crowds, key: str, handler: Handler) -> None:
        self.undeclare = partial(crowds.leave_others, key, handler)
