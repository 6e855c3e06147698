"""A QoS profile in a liveliness token.

`reliability:durability:history,depth:deadline:lifespan:liveliness,lease`, durations as `s,ns`. A value that
equals rmw_zenoh's default is left out.
"""

from __future__ import annotations

import re
from typing import Final

from rmw_local.qos import (
    AUTOMATIC,
    BEST_EFFORT,
    INFINITE,
    KEEP_ALL,
    KEEP_LAST,
    MANUAL_BY_TOPIC,
    RELIABLE,
    TRANSIENT_LOCAL,
    VOLATILE,
    QosProfile,
)

_DEPTH: Final = 42
_SECOND: Final = 1_000_000_000  # [ns]
_NUMBER: Final = r"(\d{0,10})"
_TEXT: Final = re.compile(
    ":".join(
        (
            r"(\d?)",
            r"(\d?)",
            rf"(\d?),{_NUMBER}",
            rf"{_NUMBER},{_NUMBER}",
            rf"{_NUMBER},{_NUMBER}",
            rf"(\d?),{_NUMBER},{_NUMBER}",
        )
    ),
    re.ASCII,
)


def write(profile: QosProfile) -> str:
    """The text of a resolved profile."""
    reliability = _unless(profile.reliability, RELIABLE)
    durability = _unless(profile.durability, VOLATILE)
    history = _unless(profile.history, KEEP_LAST)
    depth = _unless(profile.depth or _DEPTH, _DEPTH)
    deadline, lifespan = _duration(profile.deadline), _duration(profile.lifespan)
    liveliness, lease = _unless(profile.liveliness, AUTOMATIC), _duration(profile.liveliness_lease_duration)
    return f"{reliability}:{durability}:{history},{depth}:{deadline}:{lifespan}:{liveliness},{lease}"


def read(text: str) -> QosProfile:
    """The profile; raises ValueError for anything that no resolved profile could have."""
    found = _TEXT.fullmatch(text)
    if found is None:
        raise ValueError(f"{text[:100]!r} is not a QoS profile")
    reliability, durability, history, depth, *durations = found.groups()
    deadline_s, deadline_ns, lifespan_s, lifespan_ns, liveliness, lease_s, lease_ns = durations
    return QosProfile(
        reliability=_one_of(reliability, RELIABLE, BEST_EFFORT),
        durability=_one_of(durability, VOLATILE, TRANSIENT_LOCAL),
        history=_one_of(history, KEEP_LAST, KEEP_ALL),
        depth=int(depth or _DEPTH),
        deadline=_nanoseconds(deadline_s, deadline_ns),
        lifespan=_nanoseconds(lifespan_s, lifespan_ns),
        liveliness=_one_of(liveliness, AUTOMATIC, MANUAL_BY_TOPIC),
        liveliness_lease_duration=_nanoseconds(lease_s, lease_ns),
    )


def _unless(value: int, default: int) -> str:
    return "" if value == default else str(value)


def _duration(duration: int) -> str:
    seconds, nanoseconds = divmod(duration or INFINITE, _SECOND)
    endless = divmod(INFINITE, _SECOND)
    return f"{_unless(seconds, endless[0])},{_unless(nanoseconds, endless[1])}"


def _nanoseconds(seconds: str, nanoseconds: str) -> int:
    """A duration [ns]; 0 means that none was set, and longer ones than rmw knows are endless."""
    endless = divmod(INFINITE, _SECOND)
    whole = int(seconds or endless[0]) * _SECOND + int(nanoseconds or endless[1])
    return min(whole or INFINITE, INFINITE)


def _one_of(text: str, default: int, other: int) -> int:
    value = int(text or default)
    if value not in {default, other}:
        raise ValueError(f"{value} is not a value of this policy")
    return value
