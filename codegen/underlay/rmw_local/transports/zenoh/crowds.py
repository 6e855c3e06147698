"""The publishers, subscribers and tokens of private sessions that have very many.

Zenoh compares each one that is declared with all that are there, in each process: 4,000 topics took a process
8 to 15 s. Beyond the first ones, subscriptions share one subscriber to all topics of the domain, publishers
send by key, and tokens get keys that have less in common. Such a process gets messages that nobody in it
wants, and publishers there do not notice who listens without being announced. Sessions that are not private
go by rmw_zenoh's conventions in everything: routers, their access control and other implementations know no
others.
"""

from __future__ import annotations

import _thread
from collections.abc import Callable, Iterator
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Any, Final

import zenoh
from zenoh import Locality

from rmw_local.transports.zenoh import tokens

if TYPE_CHECKING:
    from rmw_local.transports.zenoh.presence import Gate

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
