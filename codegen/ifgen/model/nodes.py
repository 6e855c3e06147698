"""Nodes, as generators see them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Qos:
    """A QoS profile in the words of NoDL; None where it leaves a policy open. Durations are in seconds."""

    history: str
    depth: int | None
    reliability: str
    durability: str | None
    deadline: float | None
    lifespan: float | None
    liveliness: str | None
    liveliness_lease_duration: float | None


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An endpoint of a node; `category` is its list in NoDL: `publishers`, `service_clients` and so on.

    `name` is as written: absolute, relative or `~/private`. `full_name` is the name in the graph, for a node
    in the root namespace.
    """

    category: str
    name: str
    full_name: str
    type_name: str
    documentation: str
    qos: Qos | None


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter: its type as NoDL spells it, and its default as YAML; None where it must be given.

    `constraints` are its validators, such as `bounds<>: [0, 1]`.
    """

    name: str
    type: str
    default: str | None
    documentation: str
    read_only: bool
    constraints: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Timer:
    """A timer: its period in seconds, or the parameter that holds it."""

    name: str
    period: float | None
    period_parameter: str | None
    publishes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Node:
    """A node: `name` is that of its description, `node_class` its Python class.

    `endpoints` are all of `publishers`, `subscriptions`, `service_servers`, `service_clients`,
    `action_servers` and `action_clients`.
    """

    package: str
    name: str
    node_class: str
    style: str
    documentation: str
    parameters: tuple[Parameter, ...]
    endpoints: tuple[Endpoint, ...]
    publishers: tuple[Endpoint, ...]
    subscriptions: tuple[Endpoint, ...]
    service_servers: tuple[Endpoint, ...]
    service_clients: tuple[Endpoint, ...]
    action_servers: tuple[Endpoint, ...]
    action_clients: tuple[Endpoint, ...]
    timers: tuple[Timer, ...]
