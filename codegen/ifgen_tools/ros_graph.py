"""The graph as one of its nodes sees it: nodes, and their ends of topics, services and actions.

It is the same on each transport. The node is asked through its own methods, or those of `rclpy.action`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, cast

from ifgen.nodl.model import Category, QosProfile

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

# Late imports: rclpy is found once the transport has been chosen.

FRAMEWORK_TOPICS: Final = ("/rosout", "/parameter_events")
"""Topics that every node has."""

FRAMEWORK_SERVICES: Final = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
    "get_type_description",
    "get_logger_levels",
    "set_logger_levels",
)
"""Last parts of the names of services that every node has, or may have, without its author's doing."""

Gid = tuple[int, ...]
"""The number of an endpoint in its middleware."""

Queue = tuple[str, int]
"""The history of an endpoint, `KEEP_LAST` or `KEEP_ALL`, and its depth."""

_NO_QUEUES: Final[Mapping[Gid, Queue]] = MappingProxyType({})
_SEND_GOAL: Final = "/_action/send_goal"
_INFINITE: Final = 9_000_000_000_000_000_000  # ns; what middlewares report for a duration that was not set
_WITH_HASH: Final = "RIHS01_"
_PART_OF_SERVICE: Final = re.compile(r"(?P<prefix>rq|rr)(?P<name>/.+)(?:Request|Reply)")
_DDS_TYPE: Final = re.compile(r"(\w+)::(\w+)::dds_::(\w+)_")


@dataclass(frozen=True, slots=True)
class Named:
    """A topic, a service, an action or a node: its name, and its types, several if nodes disagree."""

    name: str
    types: list[str]


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A node's end of a topic, a service or an action; both names are fully qualified.

    `qos` and `type_hash` are None for services and actions. The hash is empty if the node does not say it, as
    before ROS 2 Iron.
    """

    node: str
    name: str
    category: Category
    type_name: str
    qos: QosProfile | None = None
    type_hash: str | None = None

    @property
    def is_of_framework(self) -> bool:
        """Whether nodes have such an endpoint without their author's doing."""
        if self.category.folder == "msg":
            return self.name in FRAMEWORK_TOPICS
        return self.category.folder == "srv" and self.name.rpartition("/")[2] in FRAMEWORK_SERVICES


@dataclass(frozen=True, slots=True)
class View:
    """The other nodes, each name once, and all of their endpoints."""

    nodes: tuple[str, ...]
    endpoints: tuple[Endpoint, ...]

    def visible(self) -> View:
        """The names and the nodes that are not hidden."""
        nodes = tuple(node for node in self.nodes if not is_hidden(node))
        known = set(nodes)
        ends = (each for each in self.endpoints if each.node in known and not is_hidden(each.name))
        return View(nodes, tuple(ends))

    def of_authors(self) -> View:
        """The endpoints that authors of nodes wrote: visible, not of the framework, and nothing twice."""
        shown = self.visible()
        return View(
            shown.nodes, tuple(dict.fromkeys(each for each in shown.endpoints if not each.is_of_framework))
        )

    def ends(self, name: str, category: Category) -> list[Endpoint]:
        """The endpoints of one kind that a topic, a service or an action has, sorted by node."""
        found = (each for each in self.endpoints if each.category == category and each.name == name)
        return sorted(found, key=lambda each: each.node)


@dataclass(frozen=True, slots=True)
class ServicePart:
    """A node's end of the requests or of the responses of a service, which are topics in DDS."""

    node: str
    service: str
    is_server: bool
    channel: str
    type_name: str
    type_hash: str
    gid: Gid


def is_hidden(name: str) -> bool:
    """Whether a part of the name of a topic, a service or a node begins with `_`."""
    return any(part.startswith("_") for part in name.split("/"))


def full_name(name: str, namespace: str) -> str:
    """The full name of a node: `/robot/arm` of `arm` in `/robot`."""
    return f"{namespace.rstrip('/')}/{name}"


def node_names(node: Node, include_hidden: bool = False) -> list[str]:
    """The full names of all nodes that a node sees except itself, sorted; one may be there several times."""
    own = node.get_fully_qualified_name()
    names = (full_name(*place) for place in node.get_node_names_and_namespaces())
    return sorted(name for name in names if name != own and (include_hidden or not is_hidden(name)))


def topics(node: Node) -> list[Named]:
    """The topics that a node sees, sorted by name."""
    return _sorted(node.get_topic_names_and_types())


def services(node: Node, include_hidden: bool = True) -> list[Named]:
    """The services that a node sees, sorted by name, without its own."""
    own = f"{node.get_fully_qualified_name()}/"
    return [
        each
        for each in _sorted(node.get_service_names_and_types())
        if not each.name.startswith(own) and (include_hidden or not is_hidden(each.name))
    ]


def actions(node: Node) -> list[Named]:
    """The actions that a node sees, sorted by name."""
    from rclpy.action import get_action_names_and_types

    return _sorted(get_action_names_and_types(node))


def of_node(node: Node, name: str) -> dict[Category, list[Named]]:
    """The endpoints of the node with this name. Raises RuntimeError, as rclpy's errors are, if it is gone."""
    from rclpy import action

    namespace, _, last = name.rpartition("/")
    questions: dict[Category, Callable[[str, str], list[tuple[str, list[str]]]]] = {
        Category.SUBSCRIPTION: node.get_subscriber_names_and_types_by_node,
        Category.PUBLISHER: node.get_publisher_names_and_types_by_node,
        Category.SERVICE_SERVER: node.get_service_names_and_types_by_node,
        Category.SERVICE_CLIENT: node.get_client_names_and_types_by_node,
        Category.ACTION_SERVER: partial(action.get_action_server_names_and_types_by_node, node),
        Category.ACTION_CLIENT: partial(action.get_action_client_names_and_types_by_node, node),
    }
    return {category: _sorted(ask(last, namespace or "/")) for category, ask in questions.items()}


def read(node: Node, queues: Mapping[Gid, Queue] = _NO_QUEUES) -> View:
    """The whole graph, without the node that looks.

    `queues` has the history and the depth of endpoints of topics, where the transport knows more than rclpy.
    """
    own = node.get_fully_qualified_name()
    places = {full_name(*place): place for place in node.get_node_names_and_namespaces()}
    places.pop(own, None)
    found = (*_of_topics(node, queues), *_of_services(node, places))
    return View(tuple(places), tuple(each for each in found if each.node in places))


def service_parts(node: Node) -> Iterator[ServicePart]:
    """The ends of services and actions as a middleware has them whose services are two topics each."""
    for channel, _ in node.get_topic_names_and_types(no_demangle=True):
        part = _PART_OF_SERVICE.fullmatch(channel)
        if part is None:
            continue
        is_response = part["prefix"] == "rr"
        for is_server, infos in (
            (is_response, node.get_publishers_info_by_topic(channel, no_mangle=True)),
            (not is_response, node.get_subscriptions_info_by_topic(channel, no_mangle=True)),
        ):
            for info in infos:
                yield ServicePart(
                    full_name(info.node_name, info.node_namespace),
                    part["name"],
                    is_server,
                    channel,
                    _DDS_TYPE.sub(r"\1/\2/\3", info.topic_type),
                    _hash_of(info),
                    tuple(info.endpoint_gid),
                )


def qos_of(profile: QoSProfile, queue: Queue | None = None) -> QosProfile:
    """A profile of rclpy in our terms: what a middleware does not know is left open."""

    def known(policy: Any) -> Any:
        return policy.name if policy.name != "UNKNOWN" else None

    def finite(duration: Any) -> int:
        nanoseconds = cast("int", duration.nanoseconds)
        return nanoseconds if nanoseconds < _INFINITE else 0

    history, depth = queue or (known(profile.history) or "SYSTEM_DEFAULT", profile.depth)
    return QosProfile(
        history=cast("Any", history),
        reliability=known(profile.reliability) or "SYSTEM_DEFAULT",
        depth=depth if history == "KEEP_LAST" else 0,
        durability=known(profile.durability),
        deadline_ns=finite(profile.deadline),
        lifespan_ns=finite(profile.lifespan),
        liveliness=known(profile.liveliness),
        liveliness_lease_duration_ns=finite(profile.liveliness_lease_duration),
    )


def _sorted(names_and_types: Iterable[tuple[str, Iterable[str]]]) -> list[Named]:
    return sorted((Named(name, list(types)) for name, types in names_and_types), key=lambda each: each.name)


def _of_topics(node: Node, queues: Mapping[Gid, Queue]) -> Iterator[Endpoint]:
    for topic, _ in node.get_topic_names_and_types():
        for category, infos in (
            (Category.PUBLISHER, node.get_publishers_info_by_topic(topic)),
            (Category.SUBSCRIPTION, node.get_subscriptions_info_by_topic(topic)),
        ):
            for info in infos:
                owner = full_name(info.node_name, info.node_namespace)
                qos = qos_of(info.qos_profile, queues.get(tuple(info.endpoint_gid)))
                yield Endpoint(owner, topic, category, info.topic_type, qos, _hash_of(info))


def _of_services(node: Node, places: Mapping[str, tuple[str, str]]) -> Iterator[Endpoint]:
    """The ends of services; and those of actions, which are known by the services that goals are sent to."""
    sides = (
        (Category.SERVICE_SERVER, Category.ACTION_SERVER, node.get_service_names_and_types_by_node),
        (Category.SERVICE_CLIENT, Category.ACTION_CLIENT, node.get_client_names_and_types_by_node),
    )
    for owner, place in places.items():
        for category, category_of_action, ask in sides:
            try:
                found = ask(*place)
            except RuntimeError:  # it has gone since: rclpy's NodeNameNonExistentError
                continue
            for name, types in found:
                for type_name in types:
                    end = Endpoint(owner, name, category, type_name)
                    yield end
                    if name.endswith(_SEND_GOAL):
                        yield replace(
                            end,
                            name=name.removesuffix(_SEND_GOAL),
                            category=category_of_action,
                            type_name=type_name.removesuffix("_SendGoal"),
                        )


def _hash_of(info: Any) -> str:
    """The hash of an endpoint's type; empty if there is none."""
    type_hash = str(info.topic_type_hash)
    return type_hash if type_hash.startswith(_WITH_HASH) else ""
