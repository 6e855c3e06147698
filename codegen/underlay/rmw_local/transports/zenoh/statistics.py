"""Statistics of processes: one query to all of them, and their answers.

This is ours: processes of other implementations have nobody who answers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

import zenoh
from zenoh import CongestionControl, ConsolidationMode, Locality, QueryTarget
from zenoh.handlers import FifoChannel

from rmw_local.transports.seam import OnQuestion
from rmw_local.transports.zenoh.presence import Gate

_MOST_ANSWERS: Final = 256
"""The number of answers that wait: more would hold up Zenoh until somebody looks."""
_OPTIONS: Final[dict[str, Any]] = {
    "target": QueryTarget.ALL,
    "consolidation": ConsolidationMode.NONE,
    "allowed_destination": Locality.REMOTE,
    "congestion_control": CongestionControl.DROP,
}


def answer(on_question: OnQuestion, key: str, query: zenoh.Query) -> None:
    """Answer a process that asks, whatever it sends with that."""
    query.reply(key, on_question())


def ask(gate: Gate, session: zenoh.Session, key: str, patience: float) -> Callable[[], Iterable[bytes]]:
    """Ask whoever answers by a key that this one matches; returns what returns the answers that have come."""
    channels: list[Any] = []
    # A channel has no code of Python. A callback that Zenoh's threads drop while Python ends is fatal.
    query = partial(session.get, key, FifoChannel(_MOST_ANSWERS), timeout=patience, **_OPTIONS)
    gate.call(lambda: channels.append(query()))
    return partial(_come, gate, channels[0]) if channels else tuple


def _come(gate: Gate, channel: Any) -> list[bytes]:
    found: list[bytes] = []

    def look() -> None:  # ends with an error if no more will come
        while (reply := channel.try_recv()) is not None:
            if reply.ok is not None:
                found.append(reply.ok.payload.to_bytes())

    gate.call(look)
    return found
