"""A running system at one moment, as values. None stands for a figure that nobody has told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class NodeRow:
    """A node: its process, the number of its endpoints, and the load of its executor (1 is one core)."""

    name: str
    process: str | None = None
    publishers: int = 0
    subscriptions: int = 0
    servers: int = 0
    clients: int = 0
    load: float | None = None


@dataclass(frozen=True, slots=True)
class TopicRow:
    """A topic: the nodes on it, messages a second, bytes a second, and what its subscriptions have missed.

    `fill` is the largest part of a queue that is in use, from 0 to 1. `note` says why there is no bandwidth.
    """

    name: str
    types: tuple[str, ...] = ()
    publishers: tuple[str, ...] = ()
    subscriptions: tuple[str, ...] = ()
    rate: float | None = None
    bandwidth: float | None = None
    missed: int | None = None
    fill: float | None = None
    note: str = ""


@dataclass(frozen=True, slots=True)
class SubscriptionRow:
    """A subscription: what waits, its depth (0: no limit), lost on the way, dropped by a full queue."""

    topic: str
    node: str
    waiting: int
    depth: int
    lost: int
    dropped: int


@dataclass(frozen=True, slots=True)
class ExecutorRow:
    """An executor: its load (1 is a thread that is never idle), calls a second, longest callback [s]."""

    process: str
    kind: str
    nodes: tuple[str, ...]
    threads: int
    load: float | None
    rate: float | None
    longest: float
    longest_is: str


@dataclass(frozen=True, slots=True)
class ServiceRow:
    """A service or an action, and the nodes at its ends."""

    name: str
    types: tuple[str, ...]
    servers: tuple[str, ...]
    clients: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Everything that is shown. `at` is in seconds since the epoch.

    `silent` are the nodes whose processes tell nothing of themselves: those of other implementations.
    """

    at: float
    transport: str
    nodes: tuple[NodeRow, ...] = ()
    topics: tuple[TopicRow, ...] = ()
    subscriptions: tuple[SubscriptionRow, ...] = ()
    executors: tuple[ExecutorRow, ...] = ()
    services: tuple[ServiceRow, ...] = ()
    actions: tuple[ServiceRow, ...] = ()
    silent: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of a node as (name, value), or the reason why there are none."""

    node: str
    values: tuple[tuple[str, str], ...] = ()
    problem: str = ""


def as_json(snapshot: Snapshot) -> Mapping[str, Any]:
    """The snapshot as values of JSON."""
    return asdict(snapshot)
