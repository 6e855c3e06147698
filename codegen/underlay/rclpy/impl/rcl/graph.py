"""Questions about the graph. Names and types come as `[(name, [types])]`, sorted by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from rmw_local.domain import Domain
from rmw_local.message import MessageType, service_with_hash
from rmw_local.qos import HISTORY_UNKNOWN, QosProfile
from rmw_local.service import ServiceEndpoint
from rmw_local.topic import Endpoint

from .handle import NodeNameNonExistentError, RCLError
from .names import (
    as_string,
    rclpy_get_validation_error_for_full_topic_name,
    rclpy_get_validation_error_for_namespace,
    rclpy_get_validation_error_for_node_name,
)
from .qos import profile_dict

if TYPE_CHECKING:
    from .node import Node

NamesAndTypes = list[tuple[str, list[str]]]
_Pairs = Iterable[tuple[str, str]]

_P = TypeVar("_P")  # a topic or a service

_PUBLISHER, _SUBSCRIPTION, _CLIENT, _SERVER = 1, 2, 3, 4
_EMPTY, _INVALID = 1, 2  # numbers that rcl puts into its texts
_FEEDBACK, _FEEDBACK_TYPE = "/_action/feedback", "_FeedbackMessage"


class _Snapshot:
    """All endpoints of a node's domain at one moment.

    Raises RCLError `failure: ...` when its context is down.
    """

    def __init__(self, node: Node, failure: str) -> None:
        if not node.context.valid:
            raise RCLError(f"{failure}: rcl node's context is invalid")
        self.failure = failure
        domain: Domain = node.graph_node.participant.domain
        domain.close_pending()
        with domain.lock:
            self.nodes = list(domain.nodes)
            topics, services = list(domain.topics.values()), list(domain.services.values())
            self.writers = [writer for topic in topics for writer in topic.writers]
            self.readers = [reader for topic in topics for reader in topic.readers if not reader.stands_in]
            servers = [server for service in services for server in service.servers]
            self.servers = [server for server in servers if not server.stands_in]
            self.clients = [client for service in services for client in service.clients]


class _Owner:
    """Tells the endpoints of one node; nodes of the same name count as one."""

    def __init__(self, snapshot: _Snapshot, missing: Exception, name: str, namespace: str) -> None:
        """Raise RCLError for invalid names, `missing` if there is no such node."""
        namespace = namespace or "/"
        if error := rclpy_get_validation_error_for_namespace(namespace):
            raise RCLError(f"{snapshot.failure}: {error[0]}, result: {_INVALID}")
        if error := rclpy_get_validation_error_for_node_name(name):
            raise RCLError(f"{snapshot.failure}: {error[0]}, result: {_INVALID if name else _EMPTY}")
        if not any(node.name == name and node.namespace == namespace for node in snapshot.nodes):
            raise missing
        self._name = name
        self._namespace = namespace

    def owns(self, endpoint: Endpoint | ServiceEndpoint) -> bool:
        """Whether the endpoint is the node's."""
        return endpoint.node.name == self._name and endpoint.node.namespace == self._namespace


def _grouped(pairs: _Pairs) -> NamesAndTypes:
    types: dict[str, set[str]] = {}
    for name, type_name in pairs:
        types.setdefault(name, set()).add(type_name)
    return [(name, sorted(types[name])) for name in sorted(types)]


def _topics(endpoints: Iterable[Endpoint]) -> _Pairs:
    return ((endpoint.topic, endpoint.message_type.name) for endpoint in endpoints)


def _services(endpoints: Iterable[ServiceEndpoint]) -> _Pairs:
    return ((endpoint.name, endpoint.service_type.name) for endpoint in endpoints)


def _of_node(node: Node, what: str, name: str, namespace: str) -> tuple[_Snapshot, _Owner]:
    """The graph, and its part that belongs to a node. Raises NodeNameNonExistentError or RCLError."""
    name, namespace = as_string(name), as_string(namespace)
    graph = _Snapshot(node, f"failed to get {what} names and types")
    missing = NodeNameNonExistentError(
        f"cannot get {what} names and types for nonexistent node: error not set"
    )
    return graph, _Owner(graph, missing, name, namespace)


# DDS has its own spelling of both names, which `no_demangle` asks for; services are two topics there.


def _dds_type(type_name: str, suffix: str = "") -> str:
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}{suffix}_"


def _dds_topics(endpoints: Iterable[Endpoint]) -> Iterator[tuple[str, str]]:
    for endpoint in endpoints:
        prefix = "" if endpoint.qos.avoid_ros_namespace_conventions else "rt"
        yield f"{prefix}{endpoint.topic}", _dds_type(endpoint.message_type.name)


def _dds_requests(endpoints: Iterable[ServiceEndpoint]) -> Iterator[tuple[str, str]]:
    for endpoint in endpoints:
        yield f"rq{endpoint.name}Request", _dds_type(endpoint.service_type.name, "_Request")


def _dds_replies(endpoints: Iterable[ServiceEndpoint]) -> Iterator[tuple[str, str]]:
    for endpoint in endpoints:
        yield f"rr{endpoint.name}Reply", _dds_type(endpoint.service_type.name, "_Response")


def rclpy_get_topic_names_and_types(node: Node, no_demangle: bool) -> NamesAndTypes:
    """Return every topic, or with `no_demangle` every DDS topic."""
    graph = _Snapshot(node, "failed to get topic names and types")
    endpoints: list[Endpoint] = [*graph.writers, *graph.readers]
    if not no_demangle:
        return _grouped(_topics(endpoints))
    services = [*graph.servers, *graph.clients]
    return _grouped([*_dds_topics(endpoints), *_dds_requests(services), *_dds_replies(services)])


def rclpy_get_publisher_names_and_types_by_node(
    node: Node, no_demangle: bool, node_name: str, node_namespace: str
) -> NamesAndTypes:
    """Return the topics that a node publishes on."""
    graph, owner = _of_node(node, "publisher", node_name, node_namespace)
    writers = list(filter(owner.owns, graph.writers))
    if not no_demangle:
        return _grouped(_topics(writers))
    requests = _dds_requests(filter(owner.owns, graph.clients))
    return _grouped([*_dds_topics(writers), *requests, *_dds_replies(filter(owner.owns, graph.servers))])


def rclpy_get_subscriber_names_and_types_by_node(
    node: Node, no_demangle: bool, node_name: str, node_namespace: str
) -> NamesAndTypes:
    """Return the topics that a node subscribes to."""
    graph, owner = _of_node(node, "subscriber", node_name, node_namespace)
    readers = list(filter(owner.owns, graph.readers))
    if not no_demangle:
        return _grouped(_topics(readers))
    requests = _dds_requests(filter(owner.owns, graph.servers))
    return _grouped([*_dds_topics(readers), *requests, *_dds_replies(filter(owner.owns, graph.clients))])


def rclpy_get_service_names_and_types(node: Node) -> NamesAndTypes:
    """Return every service that has a server or a client."""
    graph = _Snapshot(node, "failed to get service names and types")
    return _grouped(_services([*graph.servers, *graph.clients]))


def rclpy_get_service_names_and_types_by_node(
    node: Node, node_name: str, node_namespace: str
) -> NamesAndTypes:
    """Return the services of a node."""
    graph, owner = _of_node(node, "service", node_name, node_namespace)
    return _grouped(_services(filter(owner.owns, graph.servers)))


def rclpy_get_client_names_and_types_by_node(
    node: Node, node_name: str, node_namespace: str
) -> NamesAndTypes:
    """Return the services that a node has clients for."""
    graph, owner = _of_node(node, "client", node_name, node_namespace)
    return _grouped(_services(filter(owner.owns, graph.clients)))


def rclpy_get_publishers_info_by_topic(node: Node, topic_name: str, no_mangle: bool) -> list[dict[str, Any]]:
    """Return the keyword arguments of a TopicEndpointInfo for each publisher of a full topic name."""
    graph = _Snapshot(node, "Failed to get information by topic for publishers")
    ends = _dds_senders(graph) if no_mangle else _ends(graph.writers)
    return [_info(end, _PUBLISHER) for end in ends if end.name == topic_name]


def rclpy_get_subscriptions_info_by_topic(
    node: Node, topic_name: str, no_mangle: bool
) -> list[dict[str, Any]]:
    """Return the keyword arguments of a TopicEndpointInfo for each subscription of a full topic name."""
    graph = _Snapshot(node, "Failed to get information by topic for subscriptions")
    ends = _dds_takers(graph) if no_mangle else _ends(graph.readers)
    return [_info(end, _SUBSCRIPTION) for end in ends if end.name == topic_name]


def rclpy_get_clients_info_by_service(node: Node, service_name: str) -> list[dict[str, Any]]:
    """Return the keyword arguments of a ServiceEndpointInfo for each client of a full service name."""
    graph = _Snapshot(node, "Failed to get information by service for clients")
    return [_service_info(each, _CLIENT) for each in graph.clients if each.name == service_name]


def rclpy_get_servers_info_by_service(node: Node, service_name: str) -> list[dict[str, Any]]:
    """Return the keyword arguments of a ServiceEndpointInfo for each server of a full service name."""
    graph = _Snapshot(node, "Failed to get information by service for servers")
    return [_service_info(each, _SERVER) for each in graph.servers if each.name == service_name]


class _End(NamedTuple):
    """One end of a topic, or of a DDS topic; services have two of these."""

    name: str
    type_name: str
    endpoint: Endpoint | ServiceEndpoint
    kind: MessageType
    qos: QosProfile


def _ends(endpoints: Iterable[Endpoint]) -> Iterator[_End]:
    for each in endpoints:
        yield _End(each.topic, each.message_type.name, each, each.message_type, each.qos)


def _dds_senders(graph: _Snapshot) -> Iterator[_End]:
    for writer in graph.writers:
        yield from (_End(*pair, writer, writer.message_type, writer.qos) for pair in _dds_topics([writer]))
    for client in graph.clients:
        yield from (
            _End(*pair, client, _part(client, client.sends), client.qos.writer)
            for pair in _dds_requests([client])
        )
    for server in graph.servers:
        yield from (
            _End(*pair, server, _part(server, server.sends), server.qos.writer)
            for pair in _dds_replies([server])
        )


def _dds_takers(graph: _Snapshot) -> Iterator[_End]:
    for reader in graph.readers:
        yield from (_End(*pair, reader, reader.message_type, reader.qos) for pair in _dds_topics([reader]))
    for server in graph.servers:
        yield from (
            _End(*pair, server, _part(server, server.takes), server.qos.reader)
            for pair in _dds_requests([server])
        )
    for client in graph.clients:
        yield from (
            _End(*pair, client, _part(client, client.takes), client.qos.reader)
            for pair in _dds_replies([client])
        )


def _part(endpoint: ServiceEndpoint, kind: MessageType) -> MessageType:
    """The type of requests or responses with its hash: other processes announce the service's hash only."""
    if kind.type_hash:
        return kind
    known = service_with_hash(endpoint.service_type.name, endpoint.service_type.type_hash)
    if known is None:
        return kind
    return known.request if kind.name == known.request.name else known.response


def _service_info(end: ServiceEndpoint, endpoint_type: int) -> dict[str, Any]:
    prefix, _, digits = end.service_type.type_hash.partition("_")
    version, value = (int(prefix.removeprefix("RIHS")), bytes.fromhex(digits)) if digits else (0, bytes(32))
    return {
        "node_name": end.node.name,
        "node_namespace": end.node.namespace,
        "service_type": end.service_type.name,
        "service_type_hash": {"version": version, "value": value},
        "endpoint_type": endpoint_type,
        "endpoint_count": 1,
        "endpoint_gids": [list(end.gid)],
        "qos_profiles": [_visible_qos(end.qos.reader)],
    }


def _visible_qos(qos: QosProfile) -> dict[str, Any]:
    """A profile without the history, which DDS does not report, because it concerns no other endpoint."""
    return {**profile_dict(qos), "depth": 0, "history": HISTORY_UNKNOWN}


def _info(end: _End, endpoint_type: int) -> dict[str, Any]:
    version, value = end.kind.type_hash_value
    return {
        "node_name": end.endpoint.node.name,
        "node_namespace": end.endpoint.node.namespace,
        "topic_type": end.type_name,
        "topic_type_hash": {"version": version, "value": value},
        "endpoint_type": endpoint_type,
        "endpoint_gid": list(end.endpoint.gid),
        "qos_profile": _visible_qos(end.qos),
    }


def service_types(node: Node, service_name: str) -> list[tuple[str, str, str]]:
    """Return (full name of the node, type, type hash) of each server of a full service name.

    Jazzy has no function that says so: DDS knows the hashes of requests and responses only.
    """
    graph = _Snapshot(node, "Failed to get information about services")
    return [
        (server.node.full_name, server.service_type.name, server.service_type.type_hash)
        for server in graph.servers
        if server.name == service_name
    ]


def node_names(node: Node) -> list[tuple[str, str, str]]:
    """Return (name, namespace, enclave) of every node."""
    return [
        (each.name, each.namespace, each.enclave)
        for each in _Snapshot(node, "Failed to get node names").nodes
    ]


def count_publishers(node: Node, topic_name: str) -> int:
    """Count the publishers of a full topic name; raises RCLError for a bad one."""
    domain = _domain_of(node, "Error in rcl_count_publishers", topic_name, "topic_name")
    return _count(domain, domain.topics, topic_name, lambda topic: topic.writers)


def count_subscribers(node: Node, topic_name: str) -> int:
    """Count the subscriptions of a full topic name; raises RCLError for a bad one."""
    domain = _domain_of(node, "Error in rcl_count_subscribers", topic_name, "topic_name")
    return _count(domain, domain.topics, topic_name, lambda topic: topic.readers)


def count_clients(node: Node, service_name: str) -> int:
    """Count the clients of a full service name; raises RCLError for a bad one."""
    domain = _domain_of(node, "Error in rcl_count_clients", service_name, "service_name")
    return _count(domain, domain.services, service_name, lambda service: service.clients)


def count_services(node: Node, service_name: str) -> int:
    """Count the servers of a full service name; raises RCLError for a bad one."""
    domain = _domain_of(node, "Error in rcl_count_services", service_name, "service_name")
    return _count(domain, domain.services, service_name, lambda service: service.servers)


def _domain_of(node: Node, failure: str, name: str, argument: str) -> Domain:
    """Return a node's domain, ready to look for a name there; raises RCLError."""
    if not node.context.valid:
        raise RCLError(f"{failure}: rcl node's context is invalid")
    if error := rclpy_get_validation_error_for_full_topic_name(name):
        raise RCLError(f"{failure}: {argument} argument is invalid: {error[0]}")
    domain: Domain = node.graph_node.participant.domain
    domain.close_pending()
    return domain


def _count(domain: Domain, places: dict[str, _P], name: str, ends: Callable[[_P], Iterable[object]]) -> int:
    """Count without a look at all other names: a program may wait for thousands of them, one by one."""
    with domain.lock:
        place = places.get(name)
        return 0 if place is None else sum(not getattr(end, "stands_in", False) for end in ends(place))


# Actions are known by their feedback topics.


def action_names_and_types(node: Node) -> NamesAndTypes:
    """Return every action and its types."""
    graph = _Snapshot(node, "Failed to get action names and type")
    return _actions([*graph.writers, *graph.readers])


def action_server_names_and_types_by_node(node: Node, name: str, namespace: str) -> NamesAndTypes:
    """Return the actions that a node serves."""
    failure = "Failed to get action server names and type"
    graph = _Snapshot(node, failure)
    owner = _Owner(graph, RCLError(f"{failure}: error not set"), name, namespace)
    return _actions(filter(owner.owns, graph.writers))


def action_client_names_and_types_by_node(node: Node, name: str, namespace: str) -> NamesAndTypes:
    """Return the actions that a node has clients for."""
    failure = "Failed to get action client names and type"
    graph = _Snapshot(node, failure)
    owner = _Owner(graph, RCLError(f"{failure}: error not set"), name, namespace)
    return _actions(filter(owner.owns, graph.readers))


def _actions(endpoints: Iterable[Endpoint]) -> NamesAndTypes:
    return _grouped(
        (topic.removesuffix(_FEEDBACK), type_name.removesuffix(_FEEDBACK_TYPE))
        for topic, type_name in _topics(endpoints)
        if topic.endswith(_FEEDBACK) and type_name.endswith(_FEEDBACK_TYPE)
    )


def rclpy_get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware."""
    return "rmw_local"
