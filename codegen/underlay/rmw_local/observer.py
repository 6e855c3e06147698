"""A place to look on from: strict mode for tests records here what usually goes by silently.

Endpoints ask once, when they are created, so a run without an observer pays nothing.
"""

from __future__ import annotations

from typing import Protocol


class Observer(Protocol):
    """The recorded events.

    Calls come from any thread, some with the domain's lock held: note it down, call no middleware.
    """

    def undelivered(self, topic: str, count: int, why: str) -> None:
        """`count` messages (requests, responses) on a topic or service will never be seen."""

    def incompatible_qos(self, topic: str, policy_kind: int, writer_node: str, reader_node: str) -> None:
        """Two endpoints of one topic cannot talk; `policy_kind` is rmw's bit for the reason."""

    def opened(self, entity: object) -> None:
        """A node or an endpoint was created."""

    def closed(self, entity: object) -> None:
        """It was closed; entities that were opened and not closed are leaks."""


class _Current:
    observer: Observer | None = None


def current() -> Observer | None:
    """Return who is looking on, if anybody."""
    return _Current.observer


def install(observer: Observer | None) -> Observer | None:
    """Let `observer` look on from now on, at endpoints created from now on; return the one before it."""
    previous, _Current.observer = _Current.observer, observer
    return previous
