"""Waiting until subscriptions in other processes have what was published."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from rmw_local.qos import RELIABLE
from rmw_local.transports.interface import Receipt
from rmw_local.transports.remote import RemoteReader
from rmw_local.writer import Writer

_NO_END: Final = 100 * 365 * 86_400.0  # [s]
_GIVES_UP: Final = 2.0
"""Seconds after which a message that still has not come is lost: longer than it takes to send it again."""
_RETURNS: Final = 0.5
"""Seconds that a reader may be away, or without an answer: its connection may have broken."""
_FIRST_PAUSE: Final = 0.001  # [s], between questions
_LONGEST_PAUSE: Final = 0.05  # [s]
_SOON: Final = 0.1  # [s] until a question is asked again, which may have been lost; then twice as long

Ask = Callable[[str, float], list[Receipt] | None]
"""`rmw_local.transports.interface.Publication.receipts`."""


def wait_for_receipts(writer: Writer, ask: Ask, patience: int) -> bool:
    """Wait until all reliable readers in other processes have what was published before the call.

    `patience` is in ns, and has no end below 0. False if that time is over, or if something is lost for good.
    Processes that do not know what a receipt is, those of other implementations, are not waited for.
    """
    end = time.monotonic() + (patience / 1e9 if patience >= 0 else _NO_END)
    debts = _Debts(writer)
    pause, soon = _FIRST_PAUSE, _SOON
    slept = 0.0  # [s] since the last news
    while True:
        if debts.inquire(ask, min(soon, max(end - time.monotonic(), _SOON))):
            slept = 0.0
        if debts.settle(may_return=slept < _RETURNS):
            return True
        if debts.is_lost() or slept > _GIVES_UP or time.monotonic() >= end:
            return False
        time.sleep(pause)
        slept += pause
        pause, soon = min(2 * pause, _LONGEST_PAUSE), 2 * soon


class _Debts:
    """The readers that have yet to say that everything has come to them."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._number = number = writer.last_elsewhere
        # Nobody is owed this one and older ones: newer ones have taken their places.
        self._overwritten = max(0, number - (writer.qos.queue_length or number))
        self._peers = {
            gid: reader.peer
            for gid, reader in _reliable(writer).items()
            if writer.remote_readers.get(reader, number) < number
        }
        self._known: dict[bytes, Receipt] = {}
        self._silent: set[str] = set()  # those that did not answer when they were asked last

    def inquire(self, ask: Ask, patience: float) -> bool:
        """Ask all processes that are there; returns whether anything has come since they were asked last."""
        before = dict(self._known)
        self._silent.clear()
        for peer in {self._peers[gid] for gid in _reliable(self._writer) if gid in self._peers}:
            receipts = ask(peer, patience)
            if receipts is None:
                self._silent.add(peer)
            self._known |= {receipt.gid: receipt for receipt in receipts or ()}
        return self._known != before

    def settle(self, *, may_return: bool) -> bool:
        """Forget who has everything, and who is gone if nobody `may_return`; True if nobody is left."""
        here = _reliable(self._writer)
        self._peers = {
            gid: peer
            for gid, peer in self._peers.items()
            if not self._has_all(gid) and (may_return or (gid in here and peer not in self._silent))
        }
        return not self._peers

    def is_lost(self) -> bool:
        """Whether something that is owed will never come."""
        return any(
            receipt.newest_lost > self._overwritten
            for gid, receipt in self._known.items()
            if gid in self._peers
        )

    def _has_all(self, gid: bytes) -> bool:
        receipt = self._known.get(gid)
        if receipt is None or receipt.newest_lost > self._overwritten:
            return False
        return receipt.last >= self._number


def _reliable(writer: Writer) -> dict[bytes, RemoteReader]:
    """The matched reliable readers in other processes, by gid."""
    return {
        reader.gid: reader
        for reader in list(writer.remote_readers)  # at one moment: they come and go meanwhile
        if isinstance(reader, RemoteReader) and reader.qos.reliability == RELIABLE
    }
