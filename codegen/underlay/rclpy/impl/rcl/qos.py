"""QoS profiles as upstream's extension has them, the predefined ones, and the check whether two match."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from rmw_local.qos import (
    AUTOMATIC,
    BEST_AVAILABLE,
    BEST_AVAILABLE_DURATION,
    BEST_EFFORT,
    DURABILITY_UNKNOWN,
    HISTORY_UNKNOWN,
    INFINITE,
    LIVELINESS_BEST_AVAILABLE,
    LIVELINESS_UNKNOWN,
    MANUAL_BY_TOPIC,
    RELIABILITY_UNKNOWN,
    RELIABLE,
    SYSTEM_DEFAULT,
    TRANSIENT_LOCAL,
    VOLATILE,
    QosProfile,
)

from .clock import rcl_duration_t
from .structs import ExtensionEnum

RMW_DURATION_INFINITE = INFINITE
RMW_QOS_DEADLINE_BEST_AVAILABLE = BEST_AVAILABLE_DURATION
RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE = BEST_AVAILABLE_DURATION

_SYSTEM_DEFAULT = QosProfile(
    history=SYSTEM_DEFAULT, depth=0, reliability=SYSTEM_DEFAULT, durability=SYSTEM_DEFAULT
)
_PREDEFINED = {
    "qos_profile_default": QosProfile(),
    "qos_profile_system_default": _SYSTEM_DEFAULT,
    "qos_profile_sensor_data": QosProfile(depth=5, reliability=BEST_EFFORT),
    "qos_profile_services_default": QosProfile(),
    "qos_profile_parameters": QosProfile(depth=1000),
    "qos_profile_parameter_events": QosProfile(depth=1000),
    "qos_profile_best_available": QosProfile(
        reliability=BEST_AVAILABLE,
        durability=BEST_AVAILABLE,
        deadline=BEST_AVAILABLE_DURATION,
        liveliness=LIVELINESS_BEST_AVAILABLE,
        liveliness_lease_duration=BEST_AVAILABLE_DURATION,
    ),
    "qos_profile_unknown": replace(
        _SYSTEM_DEFAULT,
        history=HISTORY_UNKNOWN,
        reliability=RELIABILITY_UNKNOWN,
        durability=DURABILITY_UNKNOWN,
        liveliness=LIVELINESS_UNKNOWN,
    ),
}
_ACTION_STATUS = QosProfile(depth=1, durability=TRANSIENT_LOCAL)


class rmw_qos_profile_t:
    """A profile that can be handed to an endpoint; `profile` is what the middleware works with."""

    def __init__(
        self,
        history: int,
        depth: int,
        reliability: int,
        durability: int,
        lifespan: rcl_duration_t,
        deadline: rcl_duration_t,
        liveliness: int,
        liveliness_lease_duration: rcl_duration_t,
        avoid_ros_namespace_conventions: bool,
    ) -> None:
        self.profile = QosProfile(
            int(history),
            int(depth),
            int(reliability),
            int(durability),
            lifespan.nanoseconds,
            deadline.nanoseconds,
            int(liveliness),
            liveliness_lease_duration.nanoseconds,
            bool(avoid_ros_namespace_conventions),
        )

    @staticmethod
    def predefined(qos_profile_name: str) -> rmw_qos_profile_t:
        """Return one of rmw's profiles by name; raises ValueError for an unknown one."""
        profile = _PREDEFINED.get(qos_profile_name)
        if profile is None:
            raise ValueError(f"Requested unknown rmw_qos_profile: {qos_profile_name}")
        result = rmw_qos_profile_t.__new__(rmw_qos_profile_t)
        result.profile = profile
        return result

    def to_dict(self) -> dict[str, Any]:
        """Return the policies as the keyword arguments of `rclpy.qos.QoSProfile`."""
        return profile_dict(self.profile)


def profile_dict(profile: QosProfile) -> dict[str, Any]:
    """Return the keyword arguments of `rclpy.qos.QoSProfile` for a profile."""
    from rclpy.duration import Duration  # late: rclpy.duration needs this package

    return {
        "depth": profile.depth,
        "history": profile.history,
        "reliability": profile.reliability,
        "durability": profile.durability,
        "lifespan": Duration(nanoseconds=profile.lifespan),
        "deadline": Duration(nanoseconds=profile.deadline),
        "liveliness": profile.liveliness,
        "liveliness_lease_duration": Duration(nanoseconds=profile.liveliness_lease_duration),
        "avoid_ros_namespace_conventions": profile.avoid_ros_namespace_conventions,
    }


def profile_of(pyqos: object) -> QosProfile:
    """Return the middleware's profile for what a handle was given; None stands for the default."""
    if pyqos is None:
        return _PREDEFINED["qos_profile_default"]
    if not isinstance(pyqos, rmw_qos_profile_t):
        raise RuntimeError(f"expected an rmw_qos_profile_t, got {type(pyqos)}")
    return pyqos.profile


def rclpy_action_get_rmw_qos_profile(rmw_profile: str) -> dict[str, Any]:
    """Return an action's profile as keyword arguments; raises RuntimeError for an unknown one."""
    if rmw_profile != "rcl_action_qos_profile_status_default":
        raise RuntimeError(f"Requested unknown rmw_qos_profile: {rmw_profile}")
    return profile_dict(_ACTION_STATUS)


class QoSCompatibility(ExtensionEnum):
    """Whether two profiles match; WARNING: it cannot be said for sure."""

    OK = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True, slots=True, eq=False)
class QoSCheckCompatibleResult:
    """The verdict, and every reason in one text, each ended by `;`."""

    compatibility: QoSCompatibility = QoSCompatibility.OK
    reason: str = ""


def rclpy_qos_check_compatible(
    publisher_qos_profile: rmw_qos_profile_t, subscription_qos_profile: rmw_qos_profile_t
) -> QoSCheckCompatibleResult:
    """Say whether a publisher and a subscription with these profiles can talk, and if not, why not."""
    offered, requested = publisher_qos_profile.profile, subscription_qos_profile.profile
    if errors := _errors(offered, requested):
        return QoSCheckCompatibleResult(QoSCompatibility.ERROR, "".join(f"ERROR: {text};" for text in errors))
    if warnings := _warnings(offered, requested):
        return QoSCheckCompatibleResult(
            QoSCompatibility.WARNING, "".join(f"WARNING: {text};" for text in warnings)
        )
    return QoSCheckCompatibleResult()


@dataclass(frozen=True, slots=True)
class _Vague:
    """The words rmw has for a policy that is not decided yet, and for the demand it may turn out to make."""

    policy: str
    undecided: dict[int, str]
    weakest_offer: int
    strongest_request: int
    both: str
    only_requested: str
    only_offered: str


# "durabilty": rmw's spelling, part of the text that programs see
_VAGUE = (
    _Vague(
        "reliability",
        {SYSTEM_DEFAULT: "system_default", RELIABILITY_UNKNOWN: "unknown"},
        BEST_EFFORT,
        RELIABLE,
        "Publisher reliability is {} and subscription reliability is {}",
        "Best effort publisher, but subscription is {}",
        "Reliable subscription, but publisher is {}",
    ),
    _Vague(
        "durability",
        {SYSTEM_DEFAULT: "system_default", DURABILITY_UNKNOWN: "unknown"},
        VOLATILE,
        TRANSIENT_LOCAL,
        "Publisher durabilty is {} and subscription durability is {}",
        "Volatile publisher, but subscription is {}",
        "Transient local subscription, but publisher is {}",
    ),
    _Vague(
        "liveliness",
        {SYSTEM_DEFAULT: "system_default", LIVELINESS_UNKNOWN: "unknown"},
        AUTOMATIC,
        MANUAL_BY_TOPIC,
        "Publisher liveliness is {} and subscription liveliness is {}",
        "Publisher's liveliness is automatic, but subscription's is {}",
        "Subscription's liveliness is manual by topic, but publisher's is {}",
    ),
)


def _errors(offered: QosProfile, requested: QosProfile) -> list[str]:
    reasons: list[str] = []
    if offered.reliability == BEST_EFFORT and requested.reliability == RELIABLE:
        reasons.append("Best effort publisher and reliable subscription")
    if offered.durability == VOLATILE and requested.durability == TRANSIENT_LOCAL:
        reasons.append("Volatile publisher and transient local subscription")
    if requested.deadline:
        if not offered.deadline:
            reasons.append("Subscription has a deadline, but publisher does not")
        elif requested.deadline < offered.deadline:
            reasons.append("Subscription deadline is less than publisher deadline")
    if offered.liveliness == AUTOMATIC and requested.liveliness == MANUAL_BY_TOPIC:
        reasons.append("Publisher's liveliness is automatic and subscription's is manual by topic")
    if requested.liveliness_lease_duration:
        if not offered.liveliness_lease_duration:
            reasons.append("Subscription has a liveliness lease duration, but publisher does not")
        elif requested.liveliness_lease_duration < offered.liveliness_lease_duration:
            reasons.append("Subscription liveliness lease duration is less than publisher")
    return reasons


def _warnings(offered: QosProfile, requested: QosProfile) -> list[str]:
    reasons: list[str] = []
    for vague in _VAGUE:
        offer, request = getattr(offered, vague.policy), getattr(requested, vague.policy)
        of_offer, of_request = vague.undecided.get(offer), vague.undecided.get(request)
        if of_offer and of_request:
            reasons.append(vague.both.format(of_offer, of_request))
        elif of_request and offer == vague.weakest_offer:
            reasons.append(vague.only_requested.format(of_request))
        elif of_offer and request == vague.strongest_request:
            reasons.append(vague.only_offered.format(of_offer))
    return reasons
