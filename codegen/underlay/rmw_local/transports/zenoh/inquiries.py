"""Questions between processes of ours, each a query: for receipts of messages, and for statistics.

This is ours: processes of other implementations have nobody who answers.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

import zenoh
from zenoh import CongestionControl, ConsolidationMode, Locality, QueryTarget
from zenoh.handlers import FifoChannel

from rmw_local.transports.interface import OnQuestion, OnReceipts, Receipt
from rmw_local.transports.zenoh.attachments import GID
from rmw_local.transports.zenoh.presence import Gate
from rmw_local.transports.zenoh.services import TO_SERVERS

_RECEIPT: Final = struct.Struct("<16sqq")
_RECEIPT_OPTIONS: Final[dict[str, Any]] = {**TO_SERVERS, "congestion_control": CongestionControl.DROP}
_PAUSE: Final = 0.0005  # [s] between looks


def pack_receipts(receipts: Iterable[Receipt]) -> bytes:
    """The bytes of receipts, 32 each."""
    return b"".join(_RECEIPT.pack(*receipt) for receipt in receipts)


def unpack_receipts(data: bytes) -> list[Receipt]:
    """Read receipts; raises ValueError."""
    if len(data) % _RECEIPT.size:
        raise ValueError(f"receipts have {len(data)} bytes, expected a multiple of {_RECEIPT.size}")
    return [Receipt(*fields) for fields in _RECEIPT.iter_unpack(data)]


def answer_receipts(on_receipts: OnReceipts, query: zenoh.Query) -> None:
    """Answer a process that asks; raises ValueError if what it sent is no gid."""
    gid = b"" if query.payload is None else query.payload.to_bytes()
    if len(gid) != GID:
        raise ValueError(f"a question for receipts has {len(gid)} bytes, expected {GID}")
    query.reply(query.key_expr, pack_receipts(on_receipts(gid)))


def ask_receipts(gate: Gate, get: Callable[..., Any], gid: bytes, patience: float) -> list[Receipt] | None:
    """Ask a process, and wait for the answer; none if nothing comes in time, None if nobody would answer.

    Raises ValueError if what comes is no answer. No thread stays inside Zenoh meanwhile. The question gets
    lost where a connection is congested: one that waits for its turn would make Zenoh close the connection.
    """
    end = time.monotonic() + patience
    channels: list[Any] = []
    query = partial(get, FifoChannel(1), payload=gid, timeout=patience, **_RECEIPT_OPTIONS)
    gate.call(lambda: channels.append(query()))
    replies: list[Any] = [None]
    while channels and replies == [None] and time.monotonic() < end:
        time.sleep(_PAUSE)
        replies.clear()
        gate.call(lambda: replies.append(channels[0].try_recv()))  # which fails if no more will come
    if not replies:
        return None
    sample = replies[0].ok if replies[0] is not None else None
    return [] if sample is None else unpack_receipts(sample.payload.to_bytes())


_MOST_ANSWERS: Final = 256
"""The number of answers that wait: more would hold up Zenoh until somebody looks."""
_STATISTICS_OPTIONS: Final[dict[str, Any]] = {
    "target": QueryTarget.ALL,
    "consolidation": ConsolidationMode.NONE,
    "allowed_destination": Locality.REMOTE,
    "congestion_control": CongestionControl.DROP,
}


def answer_statistics(on_question: OnQuestion, key: str, query: zenoh.Query) -> None:
    """Answer a process that asks, whatever it sends with that."""
    query.reply(key, on_question())


def ask_statistics(
    gate: Gate, session: zenoh.Session, key: str, patience: float
) -> Callable[[], Iterable[bytes]]:
    """Ask whoever answers by a key that this one matches; returns what returns the answers that have come."""
    channels: list[Any] = []
    # A channel has no code of Python. A callback that Zenoh's threads drop while Python ends is fatal.
    query = partial(session.get, key, FifoChannel(_MOST_ANSWERS), timeout=patience, **_STATISTICS_OPTIONS)
    gate.call(lambda: channels.append(query()))
    return partial(_received, gate, channels[0]) if channels else tuple


def _received(gate: Gate, channel: Any) -> list[bytes]:
    found: list[bytes] = []

    def look() -> None:  # ends with an error if no more will come
        while (reply := channel.try_recv()) is not None:
            if reply.ok is not None:
                found.append(reply.ok.payload.to_bytes())

    gate.call(look)
    return found
