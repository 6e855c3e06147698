"""The variables of outputs: plain values with nothing to work out (docs/templates.md).

They are stable: an attribute is removed, or changes its meaning, only in a major version. Texts are not
quoted or indented for Python; `python...` is Python text.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

Base = Literal["bool", "int", "float", "byte", "char", "string", "message"]
AnnotationValue: TypeAlias = bool | int | float | str
Kind = Literal["message", "service", "action"]
Role = Literal["message", "request", "response", "goal", "result", "feedback"]


@dataclass(frozen=True, slots=True)
class MessageName:
    """The name of a message: `type_name` is `geometry_msgs/msg/Pose`, `module` is `geometry_msgs.msg`.

    The Python class is `name` in `module`. `interface` is the interface whose file it is in, and
    `snake_interface` the same in snake case: `Move` and `move` for `demo_msgs/srv/Move_Request`.
    """

    type_name: str
    package: str
    folder: str
    name: str
    interface: str
    snake_interface: str
    module: str


@dataclass(frozen=True, slots=True)
class TypeView:
    """The type of a field or constant; `text` is how a file spells it: `float64[<=3]`, `geometry_msgs/Pose`.

    `element` is the type of one element, and the whole type where `many` is false: `float64`, `string<=5`,
    `geometry_msgs/Pose`. `base` says what that is, and `message` which message, if it is one. `many` is true
    for arrays and sequences: `size` is the exact number of elements, `maximum_size` the largest one; both are
    None where any number will do. `minimum` and `maximum` are the limits of an integer, and `maximum_length`
    is the number of characters that a bounded string may have.
    """

    text: str
    element: str
    base: Base
    message: MessageName | None
    many: bool
    size: int | None
    maximum_size: int | None
    minimum: int | None
    maximum: int | None
    maximum_length: int | None


@dataclass(frozen=True, slots=True)
class AnnotationView:
    """An annotation of an .idl file: `@name`, `@name(value)`, or `@name(key=value)` with its `parameters`.

    Not those that say what a field or a constant has attributes for: `@default`, `@unit` and comments.
    """

    name: str
    value: AnnotationValue | None
    parameters: Mapping[str, AnnotationValue]


@dataclass(frozen=True, slots=True)
class FieldView:
    """A field. `attribute` is its name in the Python class, which differs from `name` for Python's own words.

    `default` is the declared default as a file spells it, None where there is none. `python_default` is what
    the field of a new message holds, as a Python literal; None where that is a message or several.
    """

    name: str
    attribute: str
    type: TypeView
    default: str | None
    python_default: str | None
    documentation: str
    unit: str | None
    annotations: tuple[AnnotationView, ...]


@dataclass(frozen=True, slots=True)
class ConstantView:
    """A constant: its `value` as a file spells it, and `python_value` as a Python literal."""

    name: str
    type: TypeView
    value: str
    python_value: str
    documentation: str
    unit: str | None
    annotations: tuple[AnnotationView, ...]


@dataclass(frozen=True, slots=True)
class MessageView:
    """A message, or a part of a service or action, by `role`; `name` is that of the Python class."""

    name: str
    type_name: str
    role: Role
    documentation: str
    constants: tuple[ConstantView, ...]
    fields: tuple[FieldView, ...]
    annotations: tuple[AnnotationView, ...]


@dataclass(frozen=True, slots=True)
class InterfaceView:
    """An interface: `type_name` is `demo_msgs/srv/Move`, `snake_name` is `move`, `module` is `demo_msgs.srv`.

    `messages` are its parts as they stand in its file: the message itself, request and response, or goal,
    result and feedback. `uses` are the messages that their fields hold, each once, without its own parts, and
    `source` is its file's text.
    """

    kind: Kind
    package: str
    folder: str
    name: str
    snake_name: str
    type_name: str
    type_hash: str
    module: str
    documentation: str
    messages: tuple[MessageView, ...]
    uses: tuple[MessageName, ...]
    source: str


@dataclass(frozen=True, slots=True)
class QosView:
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
class EndpointView:
    """An endpoint of a node; `category` is its list in NoDL: `publishers`, `service_clients` and so on.

    `name` is as written: absolute, relative or `~/private`. `full_name` is the name in the graph, for a node
    in the root namespace.
    """

    category: str
    name: str
    full_name: str
    type_name: str
    documentation: str
    qos: QosView | None


@dataclass(frozen=True, slots=True)
class ParameterView:
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
class TimerView:
    """A timer: its period in seconds, or the parameter that holds it."""

    name: str
    period: float | None
    period_parameter: str | None
    publishes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class NodeView:
    """A node: `name` is that of its description, `node_class` its Python class.

    `endpoints` are all of `publishers`, `subscriptions`, `service_servers`, `service_clients`,
    `action_servers` and `action_clients`.
    """

    package: str
    name: str
    node_class: str
    style: str
    documentation: str
    parameters: tuple[ParameterView, ...]
    endpoints: tuple[EndpointView, ...]
    publishers: tuple[EndpointView, ...]
    subscriptions: tuple[EndpointView, ...]
    service_servers: tuple[EndpointView, ...]
    service_clients: tuple[EndpointView, ...]
    action_servers: tuple[EndpointView, ...]
    action_clients: tuple[EndpointView, ...]
    timers: tuple[TimerView, ...]


@dataclass(frozen=True, slots=True)
class PackageView:
    """A package with its interfaces, sorted by folder and name, and its nodes, sorted by name."""

    name: str
    interfaces: tuple[InterfaceView, ...]
    nodes: tuple[NodeView, ...]
