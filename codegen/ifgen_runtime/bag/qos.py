"""The quality of service that publishers of a recorded topic offered."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final, cast

_INFINITE: Final = 2**63 - 1
"""The value that rosbag2 writes for a duration without end, as sec and nsec."""

_WORDS: Final[dict[str, tuple[str, ...]]] = {
    # By rmw's numbers, which rosbag2 wrote until ROS 2 Iron.
    "history": ("system_default", "keep_last", "keep_all", "unknown"),
    "reliability": ("system_default", "reliable", "best_effort", "unknown", "best_available"),
    "durability": ("system_default", "transient_local", "volatile", "unknown", "best_available"),
    "liveliness": (
        *("system_default", "automatic", "manual_by_node", "manual_by_topic", "unknown", "best_available"),
    ),
}
_DURATIONS: Final = ("deadline", "lifespan", "liveliness_lease_duration")


@dataclass(frozen=True, slots=True)
class OfferedQoS:
    """A QoS profile in the words of rclpy, in lower case. Durations are [ns]; None is no limit."""

    history: str = "keep_last"
    depth: int = 10
    reliability: str = "reliable"
    durability: str = "volatile"
    deadline: int | None = None
    lifespan: int | None = None
    liveliness: str = "automatic"
    liveliness_lease_duration: int | None = None
    avoid_ros_namespace_conventions: bool = False


def all_offered(profiles: Any) -> tuple[OfferedQoS, ...]:
    """The profiles of one or several."""
    several = isinstance(profiles, Iterable)
    return tuple(map(offered, cast("Iterable[Any]", profiles if several else (profiles,))))


def offered(profile: Any) -> OfferedQoS:
    """The profile of an rclpy `QoSProfile`, or one that is such a value already."""
    if isinstance(profile, OfferedQoS):
        return profile
    if isinstance(profile, int):
        return OfferedQoS(depth=profile)
    words: dict[str, Any] = {name: getattr(profile, name).name.lower() for name in _WORDS}
    durations: dict[str, Any] = {name: _limit(getattr(profile, name).nanoseconds) for name in _DURATIONS}
    conventions = bool(profile.avoid_ros_namespace_conventions)
    return OfferedQoS(**words, **durations, depth=profile.depth, avoid_ros_namespace_conventions=conventions)


def read_qos(text: str) -> tuple[OfferedQoS, ...]:
    """The profiles in the YAML text of `offered_qos_profiles`; nothing, if it is not such a text."""
    if not text.strip():
        return ()
    try:
        return profiles_of(parsed(text))
    except ValueError:
        return ()


def parsed(text: str) -> Any:
    """The value of a text in YAML. Raises ValueError."""
    import yaml  # takes long to load, and not every recording has profiles

    try:
        return yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except Exception as error:  # tags such as `!!timestamp x` raise anything
        raise ValueError(str(error)) from None


def profiles_of(listed: object) -> tuple[OfferedQoS, ...]:
    """The profiles in a list of mappings, as `metadata.yaml` has it since version 9, or in its text."""
    if isinstance(listed, str):
        return read_qos(listed)
    if not isinstance(listed, list):
        return ()
    items = cast("list[object]", listed)
    return tuple(_profile(cast("dict[str, Any]", item)) for item in items if isinstance(item, dict))


def write_qos(profiles: Sequence[OfferedQoS]) -> str:
    """The YAML text of profiles, as rosbag2 writes it."""
    return "".join(_lines(profile) for profile in profiles)


def _profile(item: dict[str, Any]) -> OfferedQoS:
    depth = item.get("depth", 0)
    words: dict[str, Any] = {name: _word(name, item.get(name)) for name in _WORDS}
    durations: dict[str, Any] = {name: _nanoseconds(item.get(name)) for name in _DURATIONS}
    return OfferedQoS(
        **words,
        **durations,
        depth=depth if isinstance(depth, int) else 0,
        avoid_ros_namespace_conventions=item.get("avoid_ros_namespace_conventions") is True,
    )


def _word(name: str, value: object) -> str:
    words = _WORDS[name]
    if isinstance(value, int):
        return words[value] if 0 <= value < len(words) else "unknown"
    return value if isinstance(value, str) and value in words else "unknown"


def _nanoseconds(value: object) -> int | None:
    if not isinstance(value, dict):
        return None
    parts = cast("dict[str, object]", value)
    sec, nsec = parts.get("sec"), parts.get("nsec")
    return _limit(sec * 10**9 + nsec) if isinstance(sec, int) and isinstance(nsec, int) else None


def _limit(nanoseconds: int) -> int | None:
    """A limit; none where it is 0, which is the default, or all that fits."""
    return nanoseconds if 0 < nanoseconds < _INFINITE else None


def _lines(profile: OfferedQoS) -> str:
    return "".join(_entries(profile)).replace("  ", "- ", 1)


def _entries(profile: OfferedQoS) -> Iterable[str]:
    yield f"  history: {profile.history}\n"
    yield f"  depth: {profile.depth}\n"
    yield f"  reliability: {profile.reliability}\n"
    yield f"  durability: {profile.durability}\n"
    for name in ("deadline", "lifespan"):
        yield _duration(name, getattr(profile, name))
    yield f"  liveliness: {profile.liveliness}\n"
    yield _duration("liveliness_lease_duration", profile.liveliness_lease_duration)
    yield f"  avoid_ros_namespace_conventions: {str(profile.avoid_ros_namespace_conventions).lower()}\n"


def _duration(name: str, nanoseconds: int | None) -> str:
    sec, nsec = divmod(_INFINITE if nanoseconds is None else nanoseconds, 10**9)
    return f"  {name}:\n    sec: {sec}\n    nsec: {nsec}\n"
