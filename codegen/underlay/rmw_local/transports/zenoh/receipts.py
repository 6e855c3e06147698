"""Receipts between processes: a query to one of them, behind what was put, and its answer.

This is ours: processes of other implementations have nobody who answers.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

import zenoh
from zenoh import CongestionControl
from zenoh.handlers import FifoChannel

from rmw_local.transports.seam import OnReceipts, Receipt
from rmw_local.transports.zenoh.attachments import GID
from rmw_local.transports.zenoh.presence import Gate
from rmw_local.transports.zenoh.services import TO_SERVERS

_RECEIPT: Final = struct.Struct("<16sqq")
_OPTIONS: Final[dict[str, Any]] = {**TO_SERVERS, "congestion_control": CongestionControl.DROP}
_PAUSE: Final = 0.0005  # [s] between looks


def pack(receipts: Iterable[Receipt]) -> bytes:
    """The bytes of receipts, 32 each."""
    return b"".join(_RECEIPT.pack(*receipt) for receipt in receipts)


def unpack(data: bytes) -> list[Receipt]:
    """Read receipts; raises ValueError."""
    if len(data) % _RECEIPT.size:
        raise ValueError(f"receipts have {len(data)} bytes, expected a multiple of {_RECEIPT.size}")
    return [Receipt(*fields) for fields in _RECEIPT.iter_unpack(data)]


def answer(on_receipts: OnReceipts, query: zenoh.Query) -> None:
    """Answer a process that asks; raises ValueError if what it sent is no gid."""
    gid = b"" if query.payload is None else query.payload.to_bytes()
    if len(gid) != GID:
        raise ValueError(f"a question for receipts has {len(gid)} bytes, expected {GID}")
    query.reply(query.key_expr, pack(on_receipts(gid)))


def ask(gate: Gate, get: Callable[..., Any], gid: bytes, patience: float) -> list[Receipt] | None:
    """Ask a process, and wait for the answer; none if nothing comes in time, None if nobody would answer.

    Raises ValueError if what comes is no answer. No thread stays inside Zenoh meanwhile. The question gets
    lost where a connection is congested: one that waits for its turn would make Zenoh close the connection.
    """
    end = time.monotonic() + patience
    channels: list[Any] = []
    query = partial(get, FifoChannel(1), payload=gid, timeout=patience, **_OPTIONS)
    gate.call(lambda: channels.append(query()))
    replies: list[Any] = [None]
    while channels and replies == [None] and time.monotonic() < end:
        time.sleep(_PAUSE)
        replies.clear()
        gate.call(lambda: replies.append(channels[0].try_recv()))  # which fails if no more will come
    if not replies:
        return None
    sample = replies[0].ok if replies[0] is not None else None
    return [] if sample is None else unpack(sample.payload.to_bytes())
