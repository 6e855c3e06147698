"""A publisher: how its messages leave the process."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import zenoh

from rmw_local.transports.seam import Receipt
from rmw_local.transports.zenoh import attachments
from rmw_local.transports.zenoh.presence import Gate, Presence


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
