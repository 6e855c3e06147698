"""Looks at the graph, asks the processes and listens, again and again; each time it makes a snapshot."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from ifgen.command_kit.tool import ToolError
from ifgen.nodl.model import Category
from ifgen_runtime.errors import printable

from ifgen_tools import discovery
from ifgen_tools.param.client import json_value, remote_parameters
from ifgen_tools.ros_graph import Endpoint, View, is_hidden, read
from ifgen_tools.top.listening import Listener, OnMessage, Tap
from ifgen_tools.top.snapshot import NodeRow, Parameters, ServiceRow, Snapshot, SubscriptionRow, TopicRow
from ifgen_tools.top.stats import Report, Stats, compare, read_report

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterValue

    from ifgen_tools.session import Session


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


_PATIENCE: Final = 0.25
"""Seconds that processes have to answer."""
_NODE_TAKES: Final = 2.0
"""Seconds that the parameter services of a node have to be there, and to answer."""
_ROUNDS: Final = 3
"""The number of snapshots for which the last report of a process is good."""


class Collector:
    """Collects on behalf of a view. One thread calls `step`, `spin` and `parameters`; `want` may be any."""

    def __init__(
        self,
        session: Session,
        *,
        include_hidden: bool = False,
        listens: bool = True,
        on_message: OnMessage = lambda *_: None,
    ) -> None:
        self._session = session
        self._domain = session.context.get_domain_id()
        self._include_hidden = include_hidden
        self._listens = listens
        self._listener = Listener(session.node, on_message)
        self._wanted: list[str] = []
        self._graph = Graph((), {}, ())
        self._reports: dict[str, Report] = {}
        self._ages: dict[str, int] = {}

    def want(self, topics: Iterable[str]) -> None:
        """Listen to these topics, from the next step on."""
        self._wanted = list(topics)

    def listen(self) -> None:
        """Begin to listen to what is wanted, without waiting for the next step."""
        self._listener.update(self._wanted if self._listens else [], self._graph.topics)

    def tap(self, topic: str) -> Tap | None:
        """The rate and the messages of a topic that is listened to."""
        return self._listener.taps.get(topic)

    def spin(self, seconds: float) -> None:
        """Receive for a while."""
        self._session.wait_for(lambda: False, seconds)

    def parameters(self, node: str) -> Parameters:
        """Ask a node for all of its parameters, and wait for the answers, but not long."""
        try:
            with remote_parameters(self._session, node, _NODE_TAKES, _NODE_TAKES) as remote:
                found = remote.all()
        except ToolError as error:
            return Parameters(node, problem=error.message)
        return Parameters(node, tuple((printable(each.name), _shown(value)) for each, value in found))

    def close(self) -> None:
        """Listen no longer."""
        self._listener.close()

    def step(self) -> Snapshot:
        """The system as it is now; rates are those since the last step."""
        node = self._session.node
        view = read(node)
        graph = graph_of(view if self._include_hidden else view.visible())
        earlier = self._reports
        if self._session.transport == "local":
            self._ask(set(graph.nodes))
        stats = compare(earlier, self._reports, node.get_fully_qualified_name())
        self._graph = graph
        self._listener.turn()
        self.listen()
        return self._together(graph, stats)

    def _ask(self, here: set[str]) -> None:
        """Ask all processes, and wait until those have answered that have done so before."""
        answers = discovery.survey(self._domain)
        fresh: dict[str, Report] = {}

        def have_answered() -> bool:
            come = (read_report(answer) for answer in answers())
            fresh.update((report.process, report) for report in come if report is not None)
            return here.issubset(node for report in fresh.values() for node in report.nodes)

        self._session.wait_for(have_answered, _PATIENCE)
        self._ages = {each: age + 1 for each, age in self._ages.items()} | dict.fromkeys(fresh, 0)
        kept = {
            process: report
            for process, report in self._reports.items()
            if self._ages[process] < _ROUNDS and here.intersection(report.nodes)
        }
        self._reports = kept | fresh
        self._ages = {process: self._ages[process] for process in self._reports}

    def _together(self, graph: Graph, stats: Stats) -> Snapshot:
        subscriptions = tuple(
            each for each in stats.subscriptions if self._include_hidden or not is_hidden(each.topic)
        )
        is_local = self._session.transport == "local"
        return Snapshot(
            at=time.time(),
            transport=self._session.transport,
            nodes=_nodes(graph, stats),
            topics=tuple(self._topic(name, graph, stats, subscriptions) for name in graph.topics),
            subscriptions=subscriptions,
            executors=stats.executors,
            services=graph.services,
            actions=graph.actions,
            silent=tuple(each for each in graph.nodes if is_local and each not in stats.processes),
        )

    def _topic(
        self, name: str, graph: Graph, stats: Stats, subscriptions: tuple[SubscriptionRow, ...]
    ) -> TopicRow:
        topic, tap = graph.topics[name], self._listener.taps.get(name)
        rate = tap.rate if tap is not None else None
        if topic.publishers and stats.counted.get(name, 0) == len(topic.publishers):
            rate = stats.rates.get(name, rate)  # exact, and nothing gets lost on the way
        bandwidth = None
        if tap is not None and rate is not None and (tap.mean_size is not None or not rate):
            bandwidth = rate * (tap.mean_size or 0)
        ends = [each for each in subscriptions if each.topic == name]
        return TopicRow(
            name,
            topic.types,
            topic.publishers,
            topic.subscriptions,
            rate,
            bandwidth,
            missed=sum(each.lost + each.dropped for each in ends) if ends else None,
            fill=max((each.waiting / each.depth for each in ends if each.depth), default=None),
            note=self._listener.notes.get(name, ""),
        )


def _nodes(graph: Graph, stats: Stats) -> tuple[NodeRow, ...]:
    publishers = [node for topic in graph.topics.values() for node in topic.publishers]
    subscriptions = [node for topic in graph.topics.values() for node in topic.subscriptions]
    servers = [node for service in graph.services for node in service.servers]
    clients = [node for service in graph.services for node in service.clients]
    return tuple(
        NodeRow(
            node,
            stats.processes.get(node),
            publishers.count(node),
            subscriptions.count(node),
            servers.count(node),
            clients.count(node),
            stats.loads.get(node),
        )
        for node in graph.nodes
    )


def _shown(message: ParameterValue | None) -> str:
    """The value of a parameter for people."""
    value = None if message is None else json_value(message)
    if value is None:
        return "not set"
    return str(value).lower() if isinstance(value, bool) else printable(str(value))
