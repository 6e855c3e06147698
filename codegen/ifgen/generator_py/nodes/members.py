"""The names of the members of a node's class, when its publishers send, and the imports of its modules.

docs/nodes.md has the rules.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Final

from ifgen.generator_py.imports import IN_NODES, Names
from ifgen.nodl.model import BaseClass, Category, Endpoint, NodeDescription, Timer
from ifgen.nodl.names import stem

TAKEN: Final = {
    *IN_NODES,
    *("Any", "Clock", "ClockType", "ExitStack", "ExternalShutdownException", "LifecycleState"),
    *("InvalidParameterTypeException", "InvalidParameterValueException", "KeyboardInterrupt"),
    *("MultiThreadedExecutor", "MutuallyExclusiveCallbackGroup", "ParametersError", "ReentrantCallbackGroup"),
    *("RunningGoal", "SetParametersResult", "TransitionCallbackReturn"),
    *("abstractmethod", "dataclass", "rclpy", "sys"),
}
"""Names that modules of nodes have a use for: those that are asked for, and those that templates write."""


class Imports(Names):
    """The names that one module of a node uses.

    The name of an interface's class is its own, or `pkg_msg_Name` if another of the node's interfaces, or a
    name that its modules need, is the same.
    """

    def __init__(self, node: NodeDescription) -> None:
        super().__init__(IN_NODES, node.package)
        self._references = references(node)
        self._modules: dict[str, str] = {}

    def interface(self, type_name: str) -> str:
        """The class of an interface."""
        package, folder, name = type_name.split("/")
        self.add(f"{package}.{folder}", name, self._references[type_name])
        return self._references[type_name]

    def base(self, base: BaseClass) -> str:
        """The class to derive from, with its module's name in front: others may share its own."""
        reference = f"{base.module.replace('.', '_')}_{base.name}"
        self.add(base.module, base.name, reference)
        return reference

    def own(self, module: str, name: str) -> str:
        """A name of another module of the package."""
        self.add(f"{self._own_package}.{module}", name)
        return name

    def function(self, path: str) -> str:
        """A function by its dotted path, with its module's name in front, since others may share its name."""
        module, _, name = path.rpartition(".")
        parent, _, last = module.rpartition(".")
        known = self._modules.setdefault(last, module)
        reference = last if known == module and last not in TAKEN else module.replace(".", "_")
        self.add(parent, last, reference)
        return f"{reference}.{name}"


def references(node: NodeDescription) -> dict[str, str]:
    """The names of interface classes in the modules of a node, by type name."""
    types = dict.fromkeys(endpoint.type_name for endpoint in node.endpoints)
    names = Counter(type_name.rpartition("/")[2] for type_name in types)
    taken = {*TAKEN, node.node_class, *_own_classes(node)}
    return {
        type_name: type_name.replace("/", "_") if names[name] > 1 or name in taken else name
        for type_name in types
        for name in (type_name.rpartition("/")[2],)
    }


def _own_classes(node: NodeDescription) -> Iterable[str]:
    return (f"{node.node_class}Base", f"{node.node_class}Parameters")


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

_NODL_ATTRIBUTES: Final = {
    Category.PUBLISHER: "pub_",
    Category.SUBSCRIPTION: "sub_",
    Category.SERVICE_SERVER: "srv_",
    Category.SERVICE_CLIENT: "cli_",
    Category.ACTION_SERVER: "action_srv_",
    Category.ACTION_CLIENT: "action_cli_",
}
"""The attributes that nodl_generator_py makes."""

# Names of rclpy's nodes, and of ours. A test compares them with rclpy.
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
    | {f"get_{end}_info_by_service" for end in ("clients", "servers")}
    | {"on_parameters_changed", "on_type_mismatch"}
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
    of_nodl = node.style == "nodl"
    endpoints = {(e.category, e.name): _members(e, taken, of_nodl=of_nodl) for e in node.endpoints}
    of_timers = {name for timer in node.timers for name in timer.publishes}
    unsent = [publisher for publisher in node.publishers if publisher.name not in of_timers]
    timers = [*node.timers, *(_timer_of(p) for p in unsent if p.qos and p.qos.deadline_ns)]
    return NodeMembers(
        endpoints,
        tuple(_clockwork(timer, node, taken) for timer in timers),
        tuple(p for p in unsent if not (p.qos and p.qos.deadline_ns)),
    )


def _members(endpoint: Endpoint, taken: set[str], *, of_nodl: bool) -> Members:
    kind = _SINGULAR[endpoint.category]
    prefixes = _METHODS[endpoint.category]
    if of_nodl and endpoint.category is Category.SERVICE_SERVER:
        prefixes = _METHODS[Category.SUBSCRIPTION]

    def names(stem: str) -> Members:
        attribute = f"{_NODL_ATTRIBUTES[endpoint.category]}{stem}" if of_nodl else f"{stem}_{kind}"
        return Members(attribute, tuple(prefix + stem for prefix in prefixes), f"{stem}_{kind}_QOS".upper())

    word = re.sub(r"[\W_]+", "_", endpoint.name).strip("_") if of_nodl else stem(endpoint.name)
    # ROS hides such names, and rclpy's nodes call what is theirs so.
    candidates = map(names, _stems(f"hidden{word}" if word.startswith("_") else word, kind))
    return next(m for m in candidates if _take({m.attribute, *m.methods, m.constant}, taken))


def _clockwork(timer: Timer, node: NodeDescription, taken: set[str]) -> Clockwork:
    stems = _stems(timer.name, "own")
    name = next(stem for stem in stems if _take({f"{stem}_timer", f"on_{stem}_timer"}, taken))
    publishers = tuple(p for p in node.publishers if p.name in timer.publishes)
    return Clockwork(timer, f"{name}_timer", f"on_{name}_timer", publishers)


def _stems(stem: str, kind: str) -> Iterator[str]:
    """The stems for names of members, best first; the last ones are for names made to collide."""
    yield from (stem, f"{stem}_{kind}")
    yield from (f"{stem}_{kind}{number}" for number in count(2))


def _take(names: set[str], taken: set[str]) -> bool:
    """Take names, unless one of them is taken."""
    is_free = taken.isdisjoint(names)
    if is_free:
        taken |= names
    return is_free


def _timer_of(publisher: Endpoint) -> Timer:
    """One that keeps a publisher's deadline even when a beat comes late: it beats twice as fast."""
    assert publisher.qos is not None
    return Timer(stem(publisher.name), period=publisher.qos.deadline_ns / 2e9, publishes=(publisher.name,))
