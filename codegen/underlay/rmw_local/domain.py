"""Everything that can hear each other: the nodes, topics and services with one domain id.

One lock guards joining and leaving; publishing never takes it. Lock order: domain, then durable writer, then
liveliness, then status. Listeners run after the domain's lock is released.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, ClassVar
from weakref import WeakSet

from rmw_local.ready import ReadySource
from rmw_local.service import ServiceName
from rmw_local.topic import Topic

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.reader import Reader
    from rmw_local.service import ServiceEndpoint
    from rmw_local.statistics import Meter, Statistics
    from rmw_local.transports.discovery import Discovery
    from rmw_local.transports.link import Link
    from rmw_local.writer import Writer


class GraphSource(ReadySource):
    """Notifies whenever an endpoint or a node comes or goes in a domain."""


class Domain:
    """Everything that can hear each other."""

    _domains: ClassVar[dict[int, Domain]] = {}
    _creation = threading.Lock()

    def __init__(self, number: int) -> None:
        self.number = number
        self.lock = threading.Lock()
        self.nodes: dict[GraphNode, None] = {}  # in the order in which they came
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, ServiceName] = {}
        self.changed = GraphSource()
        self.discovery: Discovery | None = None  # the way to other processes, once there is a node
        self.link: Link | None = None  # while there are other processes
        self.meters: WeakSet[Meter] = WeakSet()  # changed and read with the lock held
        self.statistics: Statistics | None = None  # once somebody has asked
        self._is_apart = False  # whether others know that it has a clock of its own
        self._pending: deque[Callable[[], None]] = deque()

    @classmethod
    def numbered(cls, number: int) -> Domain:
        """Return the domain with this id."""
        with cls._creation:
            return cls._domains.setdefault(number, cls(number))

    def close_later(self, close: Callable[[], None]) -> None:
        """Have something closed that was collected as garbage: later, since a collector may hold any lock."""
        self._pending.append(close)

    def close_pending(self) -> None:
        """Close what is pending. Called before looking at the graph or changing it, with no lock held."""
        while self._pending:
            try:
                close = self._pending.popleft()
            except IndexError:  # another thread was faster
                return
            close()

    def reach_out(self) -> None:
        """Look for other processes, and let them find this one."""
        if self.discovery is None:
            from rmw_local.transports.discovery import (
                Discovery,  # late: not where everything stays in the process
            )

            with self._creation:
                begins = self.discovery is None
                self.discovery = self.discovery or Discovery(self)
            if begins:
                self.discovery.begin()

    def stay_apart(self) -> None:
        """Say that other processes are not reached, because of a virtual clock, if there are any."""
        if not self._is_apart:
            from rmw_local.transports.discovery import Discovery  # late: as above

            self._is_apart = True
            Discovery(self).stay_apart()

    def topic(self, name: str) -> Topic:
        """Return the topic, a new one if it has no endpoint yet. Called with the lock held."""
        topic = self.topics.get(name)
        if topic is None:
            topic = self.topics[name] = Topic(name)
        return topic

    def service(self, name: str) -> ServiceName:
        """Return the service, a new one if it has no endpoint yet. Called with the lock held."""
        service = self.services.get(name)
        if service is None:
            service = self.services[name] = ServiceName(name)
        return service


def endpoints(domain: Domain) -> Iterator[Writer | Reader | ServiceEndpoint]:
    """Iterate over all endpoints of a domain. Called with its lock held."""
    for topic in domain.topics.values():
        yield from topic.writers
        yield from topic.readers
    for service in domain.services.values():
        yield from service.servers
        yield from service.clients


def _forget_domains() -> None:
    """Let contexts that are made in a fork meet nobody whom the forked process has.

    Threads that do not exist in the fork may have held the locks.
    """
    Domain._creation = threading.Lock()
    for domain in Domain._domains.values():
        domain.lock = threading.Lock()
    Domain._domains.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_domains)
