"""The contexts of node packages: `node` for the templates of one node, `package` for the others.

As in `messages/context.py`, strings are finished: names as they appear in Python, literals and docstrings
with their quotes, later lines with their indentation. `signature` is the first line of a method,
`documentation` the docstring of an attribute, and `docstring` that of a method.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from ifgen.nodl.model import Style


@dataclass(frozen=True, slots=True)
class PublisherText:
    """A publisher: the method `publish`, and whether that is called `once` in place of by a timer."""

    attribute: str
    publish: str
    signature: str
    message: str
    topic: str
    qos: str
    documentation: str
    docstring: str
    once: bool


@dataclass(frozen=True, slots=True)
class SubscriptionText:
    """A subscription and its callback, whose first body logs `log`."""

    attribute: str
    callback: str
    signature: str
    message: str
    topic: str
    qos: str
    documentation: str
    docstring: str
    log: str


@dataclass(frozen=True, slots=True)
class ServiceText:
    """A service server and its callback; `qos` is empty for rclpy's default."""

    attribute: str
    callback: str
    signature: str
    service: str
    name: str
    qos: str
    documentation: str
    docstring: str


@dataclass(frozen=True, slots=True)
class ClientText:
    """A service client and the method that calls; `qos` is empty for rclpy's default."""

    attribute: str
    call: str
    signature: str
    service: str
    name: str
    qos: str
    documentation: str
    docstring: str


@dataclass(frozen=True, slots=True)
class ActionServerText:
    """An action server and its three callbacks."""

    attribute: str
    accept: str
    accept_signature: str
    cancel: str
    cancel_signature: str
    execute: str
    execute_signature: str
    action: str
    name: str
    documentation: str
    accept_docstring: str
    cancel_docstring: str
    execute_docstring: str


@dataclass(frozen=True, slots=True)
class ActionClientText:
    """An action client and the method that sends a goal."""

    attribute: str
    send: str
    signature: str
    action: str
    name: str
    documentation: str
    docstring: str


@dataclass(frozen=True, slots=True)
class TimerText:
    """A timer and its callback; `clock` is empty for the node's own.

    `period` is in seconds; it `follows` where it is a parameter that can change. `publishes` are those that
    send at its rate; where there are none, the first body of the callback logs `log`.
    """

    attribute: str
    callback: str
    signature: str
    period: str
    clock: str
    follows: bool
    docstring: str
    log: str
    publishes: tuple[PublisherText, ...]


@dataclass(frozen=True, slots=True)
class NodeModule:
    """A module of a node: `_name_base.py`, which holds `base_class`, or the user's, with `node_class`.

    `name` is a literal, `plain_name` is not. `imports` are the imports of this module; `bases` are the base
    classes, `attributes` are its (name, annotation, docstring), `profiles` the constants of the QoS profiles
    with the calls that make them, `publisher_method` the method of the base that makes publishers.
    `needs_group` is true if some callbacks run beside others, `in_threads` if `main` needs more than one
    thread, and `sends_once` if a publisher is `once`. `has_long_names` is true if names are too long for the
    line breaks of `ruff format`. `ways_to_run` is for the user's module. `on_type_mismatch` is a literal, or
    empty.
    """

    package: str
    name: str
    plain_name: str
    style: Style
    title: str
    docstring: str
    imports: tuple[str, ...]
    node_class: str
    base_class: str
    bases: str
    parameters_class: str
    has_parameters: bool
    needs_group: bool
    in_threads: bool
    sends_once: bool
    has_long_names: bool
    constructor_docstring: str
    attributes: tuple[tuple[str, str, str], ...]
    profiles: tuple[tuple[str, str], ...]
    publisher_method: str
    publishers: tuple[PublisherText, ...]
    subscriptions: tuple[SubscriptionText, ...]
    services: tuple[ServiceText, ...]
    clients: tuple[ClientText, ...]
    action_servers: tuple[ActionServerText, ...]
    action_clients: tuple[ActionClientText, ...]
    on_type_mismatch: str
    timers: tuple[TimerText, ...]
    ways_to_run: str = ""


@dataclass(frozen=True, slots=True)
class ParameterText:
    """A parameter; `kind` is its `Parameter.Type`, `default` a literal, None where it must be given at start.

    `converted` is the function that makes the attribute of what rclpy holds, empty where they are the same.
    `descriptor` is a call; `rules` are (expression of `value`, literal of what it asks for), and `checks`
    functions of a value, the user's or calling them.
    """

    name: str
    kind: str
    default: str
    converted: str
    descriptor: str
    rules: tuple[tuple[str, str], ...]
    checks: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ParameterAttribute:
    """An attribute of a class of parameters."""

    name: str
    annotation: str
    docstring: str


@dataclass(frozen=True, slots=True)
class ParameterClass:
    """A dataclass of parameters: the node's own, or that of a group."""

    name: str
    docstring: str
    attributes: tuple[ParameterAttribute, ...]


@dataclass(frozen=True, slots=True)
class ParametersModule:
    """`_name_parameters.py`: the classes of groups come before those that hold them, the node's own is last.

    `made` is the expression that makes it from `values`, the values by the names of the parameters;
    `has_long_names` is as in `NodeModule`.
    """

    title: str
    name: str
    has_long_names: bool
    imports: tuple[str, ...]
    parameters_class: str
    classes: tuple[ParameterClass, ...]
    parameters: tuple[ParameterText, ...]
    made: str


@dataclass(frozen=True, slots=True)
class NodeFiles:
    """One node in the files of a package: `module` is the user's, `is_managed` a lifecycle node.

    `config` and `document` are the lines of its parameter file and of its description.
    """

    name: str
    module: str
    title: str
    is_managed: bool
    has_parameters: bool
    config: tuple[str, ...]
    document: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class NodePackageFiles:
    """The contents of package.xml, setup.py and the like; `..._literal` are Python literals.

    `registered`, `descriptions` and `configs` are literals of lists of files: those for the ament index, the
    descriptions, and the parameter files (empty if there are none). `depends` are the packages whose
    interfaces it uses, `further` the elements of other dependencies, and `requires` is a literal of a list of
    what pip installs for these. `ensured` are the literals of the packages that the runtime brings where need
    be.
    """

    name: str
    title: str
    waiting_title: str
    version: str
    description: str
    description_literal: str
    maintainer_name: str
    maintainer_name_literal: str
    maintainer_email: str
    maintainer_email_literal: str
    license: str
    license_literal: str
    depends: tuple[str, ...]
    further: tuple[str, ...]
    requires: str
    registered: str
    descriptions: str
    configs: str
    nodes: tuple[NodeFiles, ...]
    ensured: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ChecksModule:
    """A module of the user's with the functions of custom validators, each (name, parameters, docstring)."""

    title: str
    functions: tuple[tuple[str, str, str], ...]


NodeContext: TypeAlias = NodeModule | ParametersModule | NodeFiles | NodePackageFiles | ChecksModule
