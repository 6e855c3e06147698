"""What the members of a node's class are called, and when its publishers send; docs/nodes.md."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ifgen.nodl.model import Category, Endpoint, NodeDescription, Timer

_SINGULAR: Final = {
    Category.PUBLISHER: "publisher",
    Category.SUBSCRIPTION: "subscription",
    Category.SERVICE_SERVER: "service",
    Category.SERVICE_CLIENT: "client",
    Category.ACTION_SERVER: "action_server",
    Category.ACTION_CLIENT: "action_client",
}
_METHODS: Final = {
    Category.PUBLISHER: ("publish_",),
    Category.SUBSCRIPTION: ("on_",),
    Category.SERVICE_SERVER: ("handle_",),
    Category.SERVICE_CLIENT: ("call_",),
    Category.ACTION_SERVER: ("accept_", "cancel_", "execute_"),
    Category.ACTION_CLIENT: ("send_",),
}

# Of rclpy's nodes, and of ours. A test compares them with rclpy.
_CREATED = (
    "client",
    "guard_condition",
    "lifecycle_publisher",
    "publisher",
    "rate",
    "service",
    "subscription",
    "timer",
)
RESERVED: Final = frozenset(
    {f"{verb}_{kind}" for verb in ("create", "destroy") for kind in _CREATED}
    | {f"on_{change}" for change in ("configure", "cleanup", "shutdown", "activate", "deactivate", "error")}
    | {"on_parameters_changed"}
)
"""Attributes of every node that an endpoint's members could be called."""


@dataclass(frozen=True, slots=True)
class Members:
    """The names of one endpoint's members.

    `attribute` holds the entity: `odom_subscription`. `methods` are `(on_odom,)`, for an action server
    `(accept_walk, cancel_walk, execute_walk)`. `constant` is its QoS profile: `ODOM_SUBSCRIPTION_QOS`.
    """

    attribute: str
    methods: tuple[str, ...]
    constant: str


@dataclass(frozen=True, slots=True)
class Clockwork:
    """A timer of the node: its members, and the publishers that send at its rate."""

    timer: Timer
    attribute: str
    method: str
    publishers: tuple[Endpoint, ...]


@dataclass(frozen=True, slots=True)
class NodeMembers:
    """The names of everything in a node's class.

    `endpoints` are by category and name; `once` are the publishers that no timer sends on.
    """

    endpoints: Mapping[tuple[Category, str], Members]
    timers: tuple[Clockwork, ...]
    once: tuple[Endpoint, ...]

    def of(self, endpoint: Endpoint) -> Members:
        """The members of an endpoint."""
        return self.endpoints[endpoint.category, endpoint.name]


def members_of(node: NodeDescription) -> NodeMembers:
    """Name everything in a node's class, each name once."""
    taken = set(RESERVED)
    endpoints = {(e.category, e.name): _members(e, taken) for e in node.endpoints}
    of_timers = {name for timer in node.timers for name in timer.publishes}
    unsent = [publisher for publisher in node.publishers if publisher.name not in of_timers]
    timers = [*node.timers, *(_timer_of(p) for p in unsent if p.qos and p.qos.deadline_ns)]
    return NodeMembers(
        endpoints,
        tuple(_clockwork(timer, node, taken) for timer in timers),
        tuple(p for p in unsent if not (p.qos and p.qos.deadline_ns)),
    )


def _members(endpoint: Endpoint, taken: set[str]) -> Members:
    kind = _SINGULAR[endpoint.category]
    for stem in _stems(endpoint.name.lstrip("~").strip("/").replace("/", "_"), kind):
        methods = tuple(prefix + stem for prefix in _METHODS[endpoint.category])
        names = {f"{stem}_{kind}", *methods}
        if taken.isdisjoint(names):
            taken |= names
            break
    return Members(f"{stem}_{kind}", methods, f"{stem}_{kind}_QOS".upper())


def _stems(stem: str, kind: str) -> list[str]:
    """What the members may be called after, best first; the last ones are for names made to collide."""
    return [stem, f"{stem}_{kind}", *(f"{stem}_{kind}{number}" for number in range(2, 1000))]


def _timer_of(publisher: Endpoint) -> Timer:
    """One that keeps a publisher's deadline even when a beat comes late: it beats twice as fast."""
    assert publisher.qos is not None
    stem = publisher.name.lstrip("~").strip("/").replace("/", "_")
    return Timer(stem, period=publisher.qos.deadline_ns / 2e9, publishes=(publisher.name,))


def _clockwork(timer: Timer, node: NodeDescription, taken: set[str]) -> Clockwork:
    for stem in _stems(timer.name, "own"):
        names = {f"{stem}_timer", f"on_{stem}_timer"}
        if taken.isdisjoint(names):
            taken |= names
            break
    publishers = tuple(p for p in node.publishers if p.name in timer.publishes)
    return Clockwork(timer, f"{stem}_timer", f"on_{stem}_timer", publishers)
