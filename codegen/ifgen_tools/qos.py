"""QoS on the command line: options, profiles of them, and what keeps a publisher and a subscription apart."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import wraps
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import click

from ifgen_tools.ros_graph import full_name

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo

# Late imports: rclpy is found once the transport has been chosen.

Command: TypeAlias = Callable[..., Any]

_PRESETS: Final = (
    *("unknown", "default", "system_default", "sensor_data", "services_default", "parameters"),
    *("parameter_events", "action_status_default", "best_available"),
)
_POLICIES: Final = {
    "history": ("system_default", "keep_last", "keep_all", "unknown"),
    "reliability": ("system_default", "reliable", "best_effort", "unknown", "best_available"),
    "durability": ("system_default", "transient_local", "volatile", "unknown", "best_available"),
    "liveliness": ("system_default", "automatic", "manual_by_topic", "unknown", "best_available"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class QosChoice:
    """The user's choice of QoS: a preset, and policies in place of its own. None leaves it open."""

    profile: str | None = None
    depth: int | None = None
    history: str | None = None
    reliability: str | None = None
    durability: str | None = None
    liveliness: str | None = None
    liveliness_lease_duration_seconds: float | None = None

    @property
    def has_policies(self) -> bool:
        """True if the user named more than a preset."""
        return self != QosChoice(profile=self.profile)


def qos_options(command: Command) -> Command:
    """All `--qos-...`, as `qos`, which is a QosChoice."""

    @wraps(command)
    def run(**values: Any) -> Any:
        chosen = {each.name: values.pop(f"qos_{each.name}") for each in fields(QosChoice)}
        return command(qos=QosChoice(**chosen), **values)

    options = [
        click.option(
            "--qos-profile",
            type=click.Choice(_PRESETS),
            metavar="NAME",
            help=f"A profile: {', '.join(_PRESETS)}.",
        ),
        click.option(
            "--qos-depth", type=click.IntRange(min=0), metavar="N", help="In place of the profile's."
        ),
    ]
    for policy, values in _POLICIES.items():
        help = f"In place of the profile's: {', '.join(values)}."
        kind = click.Choice(values)
        options.append(click.option(f"--qos-{policy}", type=kind, help=help, metavar="POLICY"))
    options.append(
        click.option(
            "--qos-liveliness-lease-duration-seconds",
            type=click.FloatRange(min=0),
            metavar="N",
            help="The lease duration of liveliness.",
        )
    )
    for option in reversed(options):
        option(run)  # which is changed in place
    return run


def profile_of(chosen: QosChoice, default: str) -> QoSProfile:
    """The profile that the user chose; what was not said is as in the preset of the name `default`."""
    from rclpy import qos
    from rclpy.duration import Duration

    profile = qos.QoSPresetProfiles.get_from_short_key(chosen.profile or default)
    kinds: dict[str, Any] = {
        "history": qos.HistoryPolicy,
        "reliability": qos.ReliabilityPolicy,
        "durability": qos.DurabilityPolicy,
        "liveliness": qos.LivelinessPolicy,
    }
    for policy, kind in kinds.items():
        if (word := getattr(chosen, policy)) is not None:
            setattr(profile, policy, kind.get_from_short_key(word))
    if (seconds := chosen.liveliness_lease_duration_seconds) is not None:
        profile.liveliness_lease_duration = Duration(nanoseconds=round(seconds * 1e9))
    if chosen.depth is not None:
        profile.depth = chosen.depth
    elif profile.durability == qos.DurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


def fitting(profile: QoSProfile, publishers: Sequence[TopicEndpointInfo]) -> list[str]:
    """Let a profile fit all publishers, and return what has to be said about it."""
    return [
        f"Some, but not all, publishers are offering {kind}.{strong}. Falling back to "
        f"{kind}.{weak} as it will connect to all publishers"
        for policy, strong, weak in fit(profile, [info.qos_profile for info in publishers])
        for kind in (f"QoS{policy.capitalize()}Policy",)
    ]


def fit(profile: QoSProfile, offers: Sequence[QoSProfile]) -> list[tuple[str, str, str]]:
    """Let a profile fit all offers: reliable, or transient local, only if all of them are.

    Returns the policies on which they do not agree: the name, the value of some, and the one that is taken.
    """
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    mixed: list[tuple[str, str, str]] = []
    policies: tuple[tuple[str, Any, Any], ...] = (
        ("reliability", ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        ("durability", DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    )
    for policy, strong, weak in policies:
        offering = [getattr(offer, policy) == strong for offer in offers]
        if not offering:
            continue
        setattr(profile, policy, strong if all(offering) else weak)
        if any(offering) and not all(offering):
            mixed.append((policy, strong.name, weak.name))
    return mixed


def teller_of_obstacles(
    node: Node, topic: str, profile: QoSProfile, *, publishes: bool
) -> Callable[[Any], None]:
    """A callback for the event that endpoints cannot match: says on stderr whose, and by which policy.

    `publishes` says that ours is a publisher, and theirs are subscriptions.
    """
    told: set[str] = set()
    look = node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
    direction = "go to" if publishes else "come from"

    def tell(_: Any) -> None:
        for obstacle in obstacles(profile, look(topic), publishes=publishes):
            if obstacle not in told:
                told.add(obstacle)
                print(f"warning: no message will {direction} {obstacle}", file=sys.stderr, flush=True)

    return tell


def obstacles(profile: QoSProfile, others: Sequence[TopicEndpointInfo], *, publishes: bool) -> list[str]:
    """Why endpoints of others cannot match ours of this profile, one sentence for each of them.

    `publishes` says that ours is a publisher, and theirs are subscriptions.
    """
    from rclpy.qos import QoSCompatibility, qos_check_compatible

    found: list[str] = []
    for info in others:
        offered, requested = (profile, info.qos_profile) if publishes else (info.qos_profile, profile)
        compatibility, reason = qos_check_compatible(offered, requested)
        if compatibility == QoSCompatibility.ERROR:
            name = full_name(info.node_name, info.node_namespace)
            found.append(f"{name}: {_advice(offered, requested) or reason}")
    return found


def _advice(offered: QoSProfile, requested: QoSProfile) -> str:
    """The sentences about what keeps them apart, by policy."""
    parts: list[str] = []
    for policy in ("reliability", "durability", "liveliness"):
        ours, theirs = getattr(offered, policy), getattr(requested, policy)
        if (ours.name, theirs.name) == _WEAKER[policy]:
            offer, request = f"{policy} {ours.short_key}", theirs.short_key
            parts.append(f"the publisher offers {offer}, the subscription asks for {request}")
    for policy in ("deadline", "liveliness_lease_duration"):
        ours, theirs = getattr(offered, policy), getattr(requested, policy)
        if 0 < theirs.nanoseconds < (ours.nanoseconds or _INFINITE):
            shown = policy.replace("_", " ")
            parts.append(
                f"the publisher's {shown} is longer than the {theirs.nanoseconds / 1e9:g} s asked for"
            )
    return "; ".join(parts)


_INFINITE: Final = 2**63 - 1  # [ns]; unspecified is 0, and means the same
_WEAKER: Final = {
    "reliability": ("BEST_EFFORT", "RELIABLE"),
    "durability": ("VOLATILE", "TRANSIENT_LOCAL"),
    "liveliness": ("AUTOMATIC", "MANUAL_BY_TOPIC"),
}
