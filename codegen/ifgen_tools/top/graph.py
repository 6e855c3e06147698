"""The other nodes in rclpy's graph: the same on every transport."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen_tools.graph.reading import full_name, is_hidden
from ifgen_tools.top.snapshot import ServiceRow

if TYPE_CHECKING:
    from rclpy.node import Node

_SEND_GOAL: Final = "/_action/send_goal"


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic, the nodes of its endpoints (one for each), and whether all publishers keep what they sent."""

    types: tuple[str, ...]
    publishers: tuple[str, ...]
    subscriptions: tuple[str, ...]
    is_kept: bool


@dataclass(frozen=True, slots=True)
class Graph:
    """The nodes, topics and services of others, by name."""

    nodes: tuple[str, ...]
    topics: dict[str, Topic]
    services: tuple[ServiceRow, ...]
    actions: tuple[ServiceRow, ...] = ()


def look(node: Node, *, include_hidden: bool = False) -> Graph:
    """The graph as a node sees it, without that node, and without what is hidden unless that is wanted."""
    mine = node.get_fully_qualified_name()

    def is_shown(name: str) -> bool:
        return name != mine and (include_hidden or not is_hidden(name))

    places = {full_name(*found): found for found in node.get_node_names_and_namespaces()}
    places = {name: place for name, place in sorted(places.items()) if is_shown(name)}
    topics: dict[str, Topic] = {}
    for name, types in sorted(node.get_topic_names_and_types()):
        if is_shown(name):
            topic = _topic(node, name, types, lambda each: each in places)
            if topic.publishers or topic.subscriptions:
                topics[name] = topic
    found = _services(node, places)
    services = tuple(each for each in found if is_shown(each.name))
    return Graph(tuple(places), topics, services, tuple(_actions(found)))


def _topic(node: Node, name: str, types: Iterable[str], is_other: Callable[[str], bool]) -> Topic:
    publishers = [each for each in node.get_publishers_info_by_topic(name) if is_other(_whose(each))]
    subscriptions = [each for each in node.get_subscriptions_info_by_topic(name) if is_other(_whose(each))]
    is_kept = bool(publishers) and all(
        each.qos_profile.durability.name == "TRANSIENT_LOCAL" for each in publishers
    )
    return Topic(tuple(types), _nodes(publishers), _nodes(subscriptions), is_kept)


def _whose(info: Any) -> str:
    return full_name(info.node_name, info.node_namespace)


def _nodes(infos: Iterable[Any]) -> tuple[str, ...]:
    return tuple(sorted(map(_whose, infos)))


def _actions(services: Iterable[ServiceRow]) -> Iterator[ServiceRow]:
    """The actions, which are known by the services that goals are sent to."""
    for each in services:
        if each.name.endswith(_SEND_GOAL):
            types = tuple(type_name.removesuffix("_SendGoal") for type_name in each.types)
            yield ServiceRow(each.name.removesuffix(_SEND_GOAL), types, each.servers, each.clients)


def _services(node: Node, places: dict[str, tuple[str, str]]) -> tuple[ServiceRow, ...]:
    types: dict[str, tuple[str, ...]] = {}
    servers: dict[str, list[str]] = {}
    clients: dict[str, list[str]] = {}
    for full, place in places.items():
        for ends, ask in (
            (servers, node.get_service_names_and_types_by_node),
            (clients, node.get_client_names_and_types_by_node),
        ):
            try:
                found = ask(*place)
            except RuntimeError:  # it is gone meanwhile: rclpy's NodeNameNonExistentError
                continue
            for name, kinds in found:
                types[name] = tuple(kinds)
                ends.setdefault(name, []).append(full)
    return tuple(
        ServiceRow(name, types[name], tuple(servers.get(name, ())), tuple(clients.get(name, ())))
        for name in sorted(types)
    )
