"""The graph of a running system as one of its nodes sees it, on real rclpy as on ours.

Nothing of rclpy is imported: a node is asked through its own methods.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, Protocol, cast

from ifgen.graph.model import Graph, SeenEndpoint, of_endpoints
from ifgen.nodl.model import Category, QosProfile

_Names = list[tuple[str, list[str]]]

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

_SEND_GOAL = "/_action/send_goal"
_INFINITE = 9_000_000_000_000_000_000  # ns; what middlewares report for a duration that was not set


class GraphNode(Protocol):
    """The methods of `rclpy.node.Node` that ask the graph."""

    def get_fully_qualified_name(self) -> str:
        """Namespace and name."""
        ...

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """All nodes."""
        ...

    def get_topic_names_and_types(self) -> _Names:
        """All topics."""
        ...

    def get_publishers_info_by_topic(self, topic_name: str) -> list[Any]:
        """The publishers on a topic, with their QoS."""
        ...

    def get_subscriptions_info_by_topic(self, topic_name: str) -> list[Any]:
        """The subscriptions on a topic, with their QoS."""
        ...

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        """The services that a node serves."""
        ...

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        """The services that a node calls."""
        ...


def endpoints(
    node: GraphNode, profiles: Mapping[tuple[int, ...], Any] | None = None
) -> tuple[tuple[str, ...], tuple[SeenEndpoint, ...]]:
    """The other nodes, hidden ones left out, and their endpoints without what the framework adds.

    `profiles` are the QoS profiles of endpoints by gid, for transports that know more than nodes can query.
    """
    found = {
        join(namespace, name): (name, namespace) for name, namespace in node.get_node_names_and_namespaces()
    }
    found.pop(node.get_fully_qualified_name(), None)
    nodes = {full: place for full, place in found.items() if not hidden(full)}
    seen = (*_topics(node, profiles or {}), *_services(node, nodes))
    return tuple(nodes), tuple(dict.fromkeys(endpoint for endpoint in seen if endpoint.node in nodes))


def of_running(node: GraphNode) -> Graph:
    """The graph of the other nodes."""
    return of_endpoints(*endpoints(node))


def join(namespace: str, name: str) -> str:
    """A fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def hidden(name: str) -> bool:
    """Whether a part of the name begins with an underscore, as names do that users are not to see."""
    return any(part.startswith("_") for part in name.split("/"))


def _topics(node: GraphNode, profiles: Mapping[tuple[int, ...], Any]) -> Iterator[SeenEndpoint]:
    for topic, _ in node.get_topic_names_and_types():
        if hidden(topic) or topic in FRAMEWORK_TOPICS:
            continue
        for category, infos in (
            (Category.PUBLISHER, node.get_publishers_info_by_topic(topic)),
            (Category.SUBSCRIPTION, node.get_subscriptions_info_by_topic(topic)),
        ):
            for info in infos:
                full = join(info.node_namespace, info.node_name)
                profile = profiles.get(tuple(info.endpoint_gid), info.qos_profile)
                yield SeenEndpoint(full, topic, category, info.topic_type, qos_of(profile))


def _services(node: GraphNode, nodes: dict[str, tuple[str, str]]) -> Iterator[SeenEndpoint]:
    for full, (name, namespace) in nodes.items():
        for categories, names in (
            (
                (Category.SERVICE_SERVER, Category.ACTION_SERVER),
                node.get_service_names_and_types_by_node(name, namespace),
            ),
            (
                (Category.SERVICE_CLIENT, Category.ACTION_CLIENT),
                node.get_client_names_and_types_by_node(name, namespace),
            ),
        ):
            for service, types in names:
                yield from _service(full, service, types, categories)


def _service(
    node: str, service: str, types: Iterable[str], categories: tuple[Category, Category]
) -> Iterator[SeenEndpoint]:
    for type_name in types:
        if service.endswith(_SEND_GOAL):
            action = type_name.removesuffix("_SendGoal")
            yield SeenEndpoint(node, service.removesuffix(_SEND_GOAL), categories[1], action, None)
        elif not hidden(service) and service.rpartition("/")[2] not in FRAMEWORK_SERVICES:
            yield SeenEndpoint(node, service, categories[0], type_name, None)


def qos_of(profile: Any) -> QosProfile:
    """An `rclpy.qos.QoSProfile` in our terms: what a middleware does not know is left open."""

    def known(policy: Any) -> Any:
        return policy.name if policy.name != "UNKNOWN" else None

    def finite(duration: Any) -> int:
        nanoseconds = cast("int", duration.nanoseconds)
        return nanoseconds if nanoseconds < _INFINITE else 0

    history: Any = known(profile.history) or "SYSTEM_DEFAULT"
    return QosProfile(
        history=history,
        reliability=known(profile.reliability) or "SYSTEM_DEFAULT",
        depth=profile.depth if history == "KEEP_LAST" else 0,
        durability=known(profile.durability),
        deadline_ns=finite(profile.deadline),
        lifespan_ns=finite(profile.lifespan),
        liveliness=known(profile.liveliness),
        liveliness_lease_duration_ns=finite(profile.liveliness_lease_duration),
    )
