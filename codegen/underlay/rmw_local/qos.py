"""QoS profiles: the policies, which of them match, what "system default" and "best available" become.

The numbers are rmw's; rclpy shows them as enums. Durations are in ns; 0 is "not set" and acts as infinite.
Matching and the resolved defaults are those of rmw_fastrtps_cpp, the RMW of a default Jazzy installation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

INFINITE = 2**63 - 1  # [ns]
BEST_AVAILABLE_DURATION = 2**63 - 2  # [ns], a mark and no duration

SYSTEM_DEFAULT = 0  # of every policy
KEEP_LAST, KEEP_ALL, HISTORY_UNKNOWN = 1, 2, 3
RELIABLE, BEST_EFFORT, RELIABILITY_UNKNOWN = 1, 2, 3
TRANSIENT_LOCAL, VOLATILE, DURABILITY_UNKNOWN = 1, 2, 3
AUTOMATIC, MANUAL_BY_TOPIC, LIVELINESS_UNKNOWN = 1, 3, 4
BEST_AVAILABLE, LIVELINESS_BEST_AVAILABLE = 4, 5

# Policy kinds, bits as in rmw's incompatible QoS events.
DURABILITY_KIND, DEADLINE_KIND, LIVELINESS_KIND, RELIABILITY_KIND = 2, 4, 8, 16


@dataclass(frozen=True, slots=True)
class QosProfile:
    """The policies of one endpoint, as rmw's struct has them."""

    history: int = KEEP_LAST
    depth: int = 10
    reliability: int = RELIABLE
    durability: int = VOLATILE
    lifespan: int = 0
    deadline: int = 0
    liveliness: int = SYSTEM_DEFAULT
    liveliness_lease_duration: int = 0
    avoid_ros_namespace_conventions: bool = False

    @property
    def queue_length(self) -> int | None:
        """The number of samples that the history keeps; None for all of them."""
        return None if self.history == KEEP_ALL else max(self.depth, 1)


def unknown_policy(profile: QosProfile) -> str | None:
    """Name the first policy that no endpoint can be created with; None if all are usable."""
    unknown = {
        "history": HISTORY_UNKNOWN,
        "reliability": RELIABILITY_UNKNOWN,
        "durability": DURABILITY_UNKNOWN,
        "liveliness": LIVELINESS_UNKNOWN,
    }
    return next((policy for policy, value in unknown.items() if getattr(profile, policy) == value), None)


def resolve_offered(profile: QosProfile, requested: Sequence[QosProfile]) -> QosProfile:
    """Fill in a writer's defaults; `requested` are the readers present, which "best available" adapts to."""
    manual = any(reader.liveliness == MANUAL_BY_TOPIC for reader in requested)
    return _resolve(
        profile,
        default_reliability=RELIABLE,
        default_durability=TRANSIENT_LOCAL,
        available_reliability=RELIABLE,
        available_durability=TRANSIENT_LOCAL,
        available_liveliness=MANUAL_BY_TOPIC if manual else AUTOMATIC,
        available_deadline=min((reader.deadline for reader in requested), default=INFINITE),
        available_lease=min((reader.liveliness_lease_duration for reader in requested), default=INFINITE),
    )


def resolve_requested(profile: QosProfile, offered: Sequence[QosProfile]) -> QosProfile:
    """Fill in a reader's defaults; `offered` are the writers present, which "best available" adapts to."""
    reliable = all(writer.reliability == RELIABLE for writer in offered)
    durable = all(writer.durability == TRANSIENT_LOCAL for writer in offered)
    manual = offered and all(writer.liveliness == MANUAL_BY_TOPIC for writer in offered)
    return _resolve(
        profile,
        default_reliability=BEST_EFFORT,
        default_durability=VOLATILE,
        available_reliability=RELIABLE if reliable else BEST_EFFORT,
        available_durability=TRANSIENT_LOCAL if durable else VOLATILE,
        available_liveliness=MANUAL_BY_TOPIC if manual else AUTOMATIC,
        available_deadline=max((writer.deadline for writer in offered), default=INFINITE),
        available_lease=max((writer.liveliness_lease_duration for writer in offered), default=INFINITE),
    )


def _resolve(
    profile: QosProfile,
    *,
    default_reliability: int,
    default_durability: int,
    available_reliability: int,
    available_durability: int,
    available_liveliness: int,
    available_deadline: int,
    available_lease: int,
) -> QosProfile:
    liveliness = {SYSTEM_DEFAULT: AUTOMATIC, LIVELINESS_BEST_AVAILABLE: available_liveliness}
    durations = {0: INFINITE}
    return replace(
        profile,
        history=profile.history or KEEP_LAST,
        reliability={SYSTEM_DEFAULT: default_reliability, BEST_AVAILABLE: available_reliability}.get(
            profile.reliability, profile.reliability
        ),
        durability={SYSTEM_DEFAULT: default_durability, BEST_AVAILABLE: available_durability}.get(
            profile.durability, profile.durability
        ),
        lifespan=profile.lifespan or INFINITE,
        deadline={**durations, BEST_AVAILABLE_DURATION: available_deadline}.get(
            profile.deadline, profile.deadline
        ),
        liveliness=liveliness.get(profile.liveliness, profile.liveliness),
        liveliness_lease_duration={**durations, BEST_AVAILABLE_DURATION: available_lease}.get(
            profile.liveliness_lease_duration, profile.liveliness_lease_duration
        ),
    )


def mismatch(offered: QosProfile, requested: QosProfile) -> int | None:
    """Return the policy kind that keeps resolved profiles apart (the last of several), or None if they match.

    The order is DDS's numbering of its policies; a lease duration counts as liveliness.
    """
    if offered.reliability == BEST_EFFORT and requested.reliability == RELIABLE:
        return RELIABILITY_KIND
    if (
        offered.liveliness_lease_duration > requested.liveliness_lease_duration
        or offered.liveliness < requested.liveliness
    ):
        return LIVELINESS_KIND
    if offered.deadline > requested.deadline:
        return DEADLINE_KIND
    if offered.durability == VOLATILE and requested.durability == TRANSIENT_LOCAL:
        return DURABILITY_KIND
    return None
