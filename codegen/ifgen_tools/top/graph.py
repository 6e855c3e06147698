"""The graph as `ifgen top` shows it: by topic, service and action."""

from __future__ import annotations

from dataclasses import dataclass

from ifgen.nodl.model import Category

from ifgen_tools.ros_graph import Endpoint, View
from ifgen_tools.top.snapshot import ServiceRow


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic, the nodes of its endpoints (one for each), and whether all publishers keep what they sent."""

    types: tuple[str, ...]
    publishers: tuple[str, ...]
    subscriptions: tuple[str, ...]
    is_kept: bool


@dataclass(frozen=True, slots=True)
class Graph:
    """The nodes, topics, services and actions of others, by name."""

    nodes: tuple[str, ...]
    topics: dict[str, Topic]
    services: tuple[ServiceRow, ...]
    actions: tuple[ServiceRow, ...] = ()


def graph_of(view: View) -> Graph:
    """Sort a view of the graph into rows."""
    rows: dict[tuple[str, str], list[Endpoint]] = {}
    for end in sorted(view.endpoints, key=lambda end: (end.name, end.node)):
        rows.setdefault((end.category.folder, end.name), []).append(end)
    return Graph(
        tuple(sorted(view.nodes)),
        {name: _topic(ends) for (folder, name), ends in rows.items() if folder == "msg"},
        tuple(_service(name, ends) for (folder, name), ends in rows.items() if folder == "srv"),
        tuple(_service(name, ends) for (folder, name), ends in rows.items() if folder == "action"),
    )


def _topic(ends: list[Endpoint]) -> Topic:
    publishers = [end for end in ends if end.category == Category.PUBLISHER]
    return Topic(
        _types(ends),
        tuple(end.node for end in publishers),
        tuple(end.node for end in ends if end.category == Category.SUBSCRIPTION),
        bool(publishers) and all(end.qos and end.qos.durability == "TRANSIENT_LOCAL" for end in publishers),
    )


def _service(name: str, ends: list[Endpoint]) -> ServiceRow:
    def nodes(*categories: Category) -> tuple[str, ...]:
        return tuple(dict.fromkeys(end.node for end in ends if end.category in categories))

    return ServiceRow(
        name,
        _types(ends),
        nodes(Category.SERVICE_SERVER, Category.ACTION_SERVER),
        nodes(Category.SERVICE_CLIENT, Category.ACTION_CLIENT),
    )


def _types(ends: list[Endpoint]) -> tuple[str, ...]:
    return tuple(sorted({end.type_name for end in ends}))
