"""The graph of nodes: who offers and who uses which interface, and what is wrong with that."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby, product
from typing import Literal

from ifgen.nodl import names
from ifgen.nodl.model import Category, NodeDescription, QosProfile, qos_mismatch

from ifgen_tools.ros_graph import Endpoint

Kind = Literal["topic", "service", "action"]

KINDS: dict[Category, Kind] = {
    Category.PUBLISHER: "topic",
    Category.SUBSCRIPTION: "topic",
    Category.SERVICE_SERVER: "service",
    Category.SERVICE_CLIENT: "service",
    Category.ACTION_SERVER: "action",
    Category.ACTION_CLIENT: "action",
}
_SOURCES = (Category.PUBLISHER, Category.SERVICE_CLIENT, Category.ACTION_CLIENT)


@dataclass(frozen=True, slots=True)
class End:
    """A node's end of a connection; `problem` says why it can never meet one at the other side."""

    node: str
    type_name: str
    qos: QosProfile | None = None
    problem: str | None = None


@dataclass(frozen=True, slots=True)
class Connection:
    """A topic, a service or an action with its ends.

    `sources` publish or call, `targets` subscribe or serve, each in the order of the nodes. `missing` names
    the empty side, or is None.
    """

    name: str
    kind: Kind
    type_names: tuple[str, ...]
    sources: tuple[End, ...]
    targets: tuple[End, ...]

    @property
    def missing(self) -> str | None:
        """The missing side: `no subscription`, `no service server` and so on."""
        source, target = {
            "topic": ("publisher", "subscription"),
            "service": ("client", "server"),
            "action": ("client", "server"),
        }[self.kind]
        if self.sources and self.targets:
            return None
        return f"no {target}" if self.sources else f"no {source}"


@dataclass(frozen=True, slots=True)
class Graph:
    """Nodes by their fully qualified names, and what they talk over, both sorted by name."""

    nodes: tuple[str, ...]
    connections: tuple[Connection, ...]

    @property
    def problems(self) -> tuple[str, ...]:
        """One sentence for each pair of ends that can never meet."""
        ends = (end for c in self.connections for end in (*c.sources, *c.targets))
        return tuple(dict.fromkeys(end.problem for end in ends if end.problem))


def of_descriptions(nodes: Iterable[NodeDescription]) -> Graph:
    """The graph of nodes that all run in the root namespace, each under the name of its description."""
    nodes = tuple(nodes)
    endpoints = (end for node in nodes for end in _endpoints(node))
    return of_endpoints((f"/{node.name}" for node in nodes), endpoints)


def of_endpoints(nodes: Iterable[str], endpoints: Iterable[Endpoint]) -> Graph:
    """The graph of nodes and their endpoints."""

    def place(endpoint: Endpoint) -> tuple[str, Kind]:
        return endpoint.name, KINDS[endpoint.category]

    by_place = groupby(sorted(endpoints, key=lambda e: (*place(e), e.node)), key=place)
    connections = tuple(_connection(name, kind, tuple(ends)) for (name, kind), ends in by_place)
    return Graph(tuple(sorted(set(nodes))), connections)


def _endpoints(node: NodeDescription) -> Iterator[Endpoint]:
    for each in node.endpoints:
        name = names.expanded(each.name, node.name)
        yield Endpoint(f"/{node.name}", name, each.category, each.type_name, each.qos)


def _connection(name: str, kind: Kind, endpoints: tuple[Endpoint, ...]) -> Connection:
    sources = [endpoint for endpoint in endpoints if endpoint.category in _SOURCES]
    targets = [endpoint for endpoint in endpoints if endpoint.category not in _SOURCES]
    problems: dict[Endpoint, str] = {}
    for source, target in product(sources, targets):
        if (why := _why_never(source, target)) is not None:
            sentence = f"{name}: {source.node} and {target.node} never meet: {why}"
            problems.setdefault(source, sentence)
            problems.setdefault(target, sentence)

    def ends(side: Iterable[Endpoint]) -> Iterator[End]:
        for endpoint in side:
            yield End(endpoint.node, endpoint.type_name, endpoint.qos, problems.get(endpoint))

    type_names = tuple(sorted({endpoint.type_name for endpoint in endpoints}))
    return Connection(name, kind, type_names, tuple(ends(sources)), tuple(ends(targets)))


def _why_never(source: Endpoint, target: Endpoint) -> str | None:
    if source.type_name != target.type_name:
        return f"one has {source.type_name}, the other {target.type_name}"
    if source.qos is None or target.qos is None:
        return None
    if KINDS[source.category] == "topic":
        return qos_mismatch(source.qos, target.qos)
    # Requests go one way and responses the other, both with the profile of the end that sends them.
    return qos_mismatch(source.qos, target.qos) or qos_mismatch(target.qos, source.qos)
