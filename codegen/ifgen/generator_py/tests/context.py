"""The contexts of tests: frozen dataclasses whose strings are finished Python text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class MessageCase:
    """A message class in the tests: `arguments` are those of a Case, as (name, value)."""

    message: str
    strategy: str
    arguments: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class InterfaceTests:
    """The test module of an interface package.

    `imports` are the modules of message classes, `values` the strategies of values other than messages, and
    `strategies` those of messages, each after those that it needs; both as (name, strategy).
    """

    title: str
    imports: tuple[str, ...]
    values: tuple[tuple[str, str], ...]
    strategies: tuple[tuple[str, str], ...]
    cases: tuple[MessageCase, ...]
    has_floats: bool


@dataclass(frozen=True, slots=True)
class TopicText:
    """A publisher or a subscription; `messages` is the strategy of its messages."""

    name: str
    type_name: str
    message: str
    qos: str
    method: str
    attribute: str
    messages: str


@dataclass(frozen=True, slots=True)
class ServiceText:
    """A service server or client; `qos` is None where the description says nothing."""

    name: str
    type_name: str
    service: str
    qos: str
    method: str
    attribute: str
    requests: str
    responses: str


@dataclass(frozen=True, slots=True)
class ActionText:
    """An action server or client; `methods` is a tuple of literals."""

    name: str
    type_name: str
    action: str
    methods: str
    attribute: str
    goals: str
    feedback: str
    results: str


@dataclass(frozen=True, slots=True)
class ParameterText:
    """The arguments of a ParameterCase."""

    arguments: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TimerText:
    """A timer: two literals, its period in seconds, whether it follows ROS time, and what it publishes."""

    method: str
    attribute: str
    period: str
    in_ros_time: str
    publishes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CallbackText:
    """A method of the user's, and the function that takes its place where it is not to be called."""

    name: str
    idle: str


@dataclass(frozen=True, slots=True)
class AskedText:
    """A service or an action that a node is a client of: full name, class, and the QoS of a service."""

    name: str
    interface: str
    qos: str = ""


@dataclass(frozen=True, slots=True)
class OwnServerText:
    """A server of a node that is also a client of it: its full name, and the attribute that has it.

    `servers` are those of the fixture `ros` that it belongs to: a service and an action may have one name.
    """

    servers: str
    name: str
    attribute: str


@dataclass(frozen=True, slots=True)
class NodeTests:
    """The contract tests of a node, which are ours.

    `own_tests` is the user's file. `given` are the parameters that need a value at start, as (name, value).
    `asked_...` are answered by others, in every test. Endpoints are looked for, and `exercises_...` says
    whether they are used, too. Names that no group of tests needs are empty. `profiles` and `notes` say which
    helpers the tests need.
    """

    title: str
    own_tests: str
    imports: tuple[str, ...]
    node_class: str
    base_class: str
    is_async: bool
    is_managed: bool
    is_clock: bool
    has_parameters: bool
    accepts_goals: bool
    callbacks: tuple[CallbackText, ...]
    asked_services: tuple[AskedText, ...]
    asked_actions: tuple[AskedText, ...]
    own_servers: tuple[OwnServerText, ...]
    given: tuple[tuple[str, str], ...]
    values: tuple[tuple[str, str], ...]
    strategies: tuple[tuple[str, str], ...]
    publishers: tuple[TopicText, ...]
    subscriptions: tuple[TopicText, ...]
    services: tuple[ServiceText, ...]
    clients: tuple[ServiceText, ...]
    action_servers: tuple[ActionText, ...]
    action_clients: tuple[ActionText, ...]
    parameters: tuple[ParameterText, ...]
    timers: tuple[TimerText, ...]
    has_lifecycle: bool
    exercises_topics: bool
    exercises_services: bool
    exercises_actions: bool
    profiles: bool
    notes: bool


@dataclass(frozen=True, slots=True)
class OwnTests:
    """The user's file of tests, with a first one: of a publisher, a service, an action, or just a start.

    `method` is what it is about, `arguments` are those that start the node. `endpoint` is a literal,
    `interface` its class, `qos` its profile, if any, and `expected` the message that comes. The attribute
    `timer`, its `period` [s] and `in_ros_time` are a publisher's. `has_long_names`: lines may be too long.
    """

    name: str
    imports: tuple[str, ...]
    kind: Literal["publisher", "service", "action", "start"]
    method: str
    arguments: str
    is_managed: bool
    endpoint: str
    interface: str = ""
    expected: str = ""
    qos: str = ""
    timer: str = ""
    period: str = ""
    in_ros_time: bool = False
    has_long_names: bool = False


@dataclass(frozen=True, slots=True)
class TestSupport:
    """The common part of the tests of a package's nodes."""

    title: str
