"""QoS of what is recorded and played: profiles that fit those of publishers, and those that users write."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

import yaml
from ifgen_runtime.bag.qos import OfferedQoS
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from ifgen_tools.errors import ToolError
from ifgen_tools.qos import fit

_POLICIES: Final[dict[str, Any]] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
_TIMES: Final = ("deadline", "lifespan", "liveliness_lease_duration")
_BASIC: Final = {"depth": int, "avoid_ros_namespace_conventions": bool}
_DEPTH: Final = 10
"""Messages that wait, unless somebody says otherwise: as rosbag2 has it."""

_S: Final = 10**9
_EXAMPLE: Final = "each topic has its policies below it, as in `/scan: {reliability: best_effort, depth: 10}`"


def overrides(path: Path | None) -> dict[str, QoSProfile]:
    """The profiles by topic in a YAML file, as `ros2 bag` reads it. Raises ToolError."""
    if path is None:
        return {}
    try:
        found: object = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        reason = " ".join(str(error).split())
        raise ToolError(f"{path} cannot be read as YAML: {reason}", help=_EXAMPLE) from None
    if not isinstance(found, dict):
        raise ToolError(f"{path} has no topics", help=_EXAMPLE)
    topics = cast("dict[object, object]", found)
    return {str(topic): _override(path, topic, entry) for topic, entry in topics.items()}


def adapted_request(offers: Sequence[QoSProfile], depth: int = _DEPTH) -> tuple[QoSProfile, list[str]]:
    """The profile to ask of publishers so that all of them match, and the policies they do not agree on.

    Deadline, lifespan and liveliness are left open.
    """
    profile = QoSProfile(depth=depth)
    return profile, [policy for policy, _, _ in fit(profile, offers)]


def adapted_offer(recorded: Sequence[OfferedQoS]) -> tuple[QoSProfile, bool]:
    """The profile to offer for publishers that were recorded, and whether these disagree.

    If they do, or nothing is known, it is the default.
    """
    if not recorded:
        return QoSProfile(depth=_DEPTH), False
    first = recorded[0]
    if any(_compatibility(other) != _compatibility(first) for other in recorded[1:]):
        return QoSProfile(depth=_DEPTH), True
    entry = {name: getattr(first, name) for name in _POLICIES}
    known = {name: _policy(name, word) for name, word in entry.items() if word != "unknown"}
    times = {name: Duration(nanoseconds=getattr(first, name) or 0) for name in _TIMES}
    return QoSProfile(**known, **times, depth=first.depth or _DEPTH), False


def _compatibility(offer: OfferedQoS) -> tuple[object, ...]:
    """The policies that decide whether endpoints match."""
    liveliness = offer.liveliness, offer.liveliness_lease_duration
    return offer.reliability, offer.durability, offer.deadline, *liveliness


def _override(path: Path, topic: object, entry: object) -> QoSProfile:
    wrong = f"{path}: the QoS of {topic}"
    if not isinstance(entry, dict):
        raise ToolError(f"{wrong} has no policies", help=_EXAMPLE)
    try:
        return _profile(cast("dict[str, Any]", entry))
    except (ValueError, AssertionError, InvalidQoSProfileException) as error:
        raise ToolError(f"{wrong} is wrong: {error}", help=_EXAMPLE) from None


def _profile(entry: Mapping[str, Any]) -> QoSProfile:
    policies: dict[str, Any] = {"depth": _DEPTH}
    for name, value in entry.items():
        if name in _POLICIES:
            policies[name] = _policy(name, value)
        elif name in _TIMES:
            policies[name] = _duration(name, value)
        elif name in _BASIC:
            if not isinstance(value, int) or type(value) is not _BASIC[name] or value < 0:
                raise ValueError(f"{name} cannot be {value!r}")
            policies[name] = value
        else:
            raise ValueError(f"there is no policy {name!r}")
    return QoSProfile(**policies)


def _policy(name: str, value: object) -> Any:
    kind = _POLICIES[name]
    found = getattr(kind, str(value).upper(), None)
    if not isinstance(found, kind):
        names = ", ".join(policy.name.lower() for policy in kind if policy.name != "UNKNOWN")
        raise ValueError(f"{name} is one of {names}, not {value!r}")
    return found


def _duration(name: str, value: object) -> Duration:
    parts = cast("dict[str, object]", value) if isinstance(value, dict) else {}
    sec, nsec = parts.get("sec"), parts.get("nsec")
    if not isinstance(sec, int) or not isinstance(nsec, int):
        raise ValueError(f"{name} has to be {{sec: SECONDS, nsec: NANOSECONDS}}, not {value!r}")
    if sec < 0 or nsec < 0:
        raise ValueError(f"{name} cannot be negative")
    return Duration(nanoseconds=min(sec * _S + nsec, 2**63 - 1))
