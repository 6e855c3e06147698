"""From the description of a node to the tests that hold it to that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from sys import stdlib_module_names
from typing import Final

from ifgen.definition.interfaces import Action, Registry, Service
from ifgen.generator_py.nodes.members import Clockwork, NodeMembers, members_of
from ifgen.generator_py.nodes.parameters import KINDS, declared
from ifgen.generator_py.nodes.qos import arguments
from ifgen.generator_py.nodes.text import literal, quoted
from ifgen.generator_py.parameter_values import accepted, refused
from ifgen.generator_py.scope import statements
from ifgen.generator_py.strategies import Strategies
from ifgen.generator_py.test_context import (
    ActionText,
    NodeTests,
    ParameterText,
    ServiceText,
    TimerText,
    TopicText,
)
from ifgen.nodl.model import Endpoint, NodeDescription, Parameter, ParameterValue, Timer

_HOME: Final = {
    "GoalStatus": "action_msgs.msg",
    "array": "array",
    "Callable": "collections.abc",
    "Iterator": "collections.abc",
    "deepcopy": "copy",
    "dataclass": "dataclasses",
    "partial": "functools",
    "find_spec": "importlib.util",
    "pairwise": "itertools",
    "attrgetter": "operator",
    "os": "",
    "Path": "pathlib",
    "re": "",
    "tempfile": "",
    "time": "",
    "Any": "typing",
    "TypeAlias": "typing",
    "HealthCheck": "hypothesis",
    "Phase": "hypothesis",
    "configuration": "hypothesis",
    "given": "hypothesis",
    "settings": "hypothesis",
    "GetState": "lifecycle_msgs.srv",
    "ActionClient": "rclpy.action",
    "ActionServer": "rclpy.action",
    "CancelResponse": "rclpy.action",
    "GoalResponse": "rclpy.action",
    "get_action_client_names_and_types_by_node": "rclpy.action",
    "get_action_server_names_and_types_by_node": "rclpy.action",
    "Duration": "rclpy.duration",
    "TransitionCallbackReturn": "rclpy.lifecycle",
    "Parameter": "rclpy.parameter",
    "DurabilityPolicy": "rclpy.qos",
    "HistoryPolicy": "rclpy.qos",
    "LivelinessPolicy": "rclpy.qos",
    "QoSProfile": "rclpy.qos",
    "ReliabilityPolicy": "rclpy.qos",
    "Future": "rclpy.task",
}
# What the module calls its own.
_OWN: Final = {"Topic", "ServiceCase", "ActionCase", "ParameterCase", "TimerCase", "Goals", "Strategy"}


class _Imports:
    """The names that the module uses, and where they come from."""

    def __init__(self) -> None:
        self._used: set[tuple[str, str, str]] = set()

    def __call__(self, *names: str) -> str:
        """Import something of Python's, hypothesis' or rclpy's; returns the last name."""
        self._used.update((_HOME[name], name, name) for name in names)
        return names[-1]

    def add(self, module: str, name: str, spelling: str) -> None:
        """Import a name of another module, as `spelling`."""
        self._used.add((module, name, spelling))

    def statements(self, *, standard: bool) -> tuple[str, ...]:
        """The import statements of the standard library, or the others."""
        return statements(
            (module, name, spelling)
            for module, name, spelling in self._used
            if ((module or name).partition(".")[0] in stdlib_module_names) == standard
        )


def node_tests(node: NodeDescription, registry: Registry) -> NodeTests | None:
    """The tests of a node, in the groups that its description names, or all; None if there are none."""
    tests = _Writer(node, registry).tests()
    endpoints = (tests.publishers, tests.subscriptions, tests.services, tests.clients)
    others = (tests.action_servers, tests.action_clients, tests.parameters, tests.timers)
    return tests if any((*endpoints, *others, tests.has_lifecycle)) else None


class _Writer:
    """Collects what one module of tests needs."""

    def __init__(self, node: NodeDescription, registry: Registry) -> None:
        self._node = node
        self._registry = registry
        self._strategies = Strategies(registry)
        self._imports = _Imports()
        self._members: NodeMembers = members_of(node)

    def tests(self) -> NodeTests:
        node = self._node
        of_topics, of_services, of_actions = map(self._has, ("topics", "services", "actions"))
        contract = self._has("contract")
        publishers = tuple(map(self._topic, node.publishers if of_topics or contract else ()))
        subscriptions = tuple(map(self._topic, node.subscriptions if of_topics or contract else ()))
        services = tuple(map(self._service, node.service_servers if of_services or contract else ()))
        clients = tuple(map(self._service, node.service_clients if of_services or contract else ()))
        action_servers = tuple(map(self._action, node.action_servers if of_actions or contract else ()))
        action_clients = tuple(map(self._action, node.action_clients if of_actions or contract else ()))
        parameters = tuple(map(self._parameter, declared(node) if self._has("parameters") else ()))
        timers = tuple(map(self._timer, self._members.timers if self._has("rates") else ()))
        notes = bool((of_topics and subscriptions) or timers)
        found = NodeTests(
            title=f"Tests of the contract of the node {node.name}: generated by ifgen, do not edit.",
            own_tests=f"test_{node.name}.py",
            standard_imports=(),
            imports=(),
            node_class=self._node_class(),
            is_async=node.style == "asyncio",
            is_managed=node.style == "lifecycle",
            time_option=", use_sim_time=False" if is_clock(node) else "",
            given=given_at_start(node),
            values=self._strategies.values,
            strategies=self._strategies.messages,
            publishers=publishers,
            subscriptions=subscriptions,
            services=services,
            clients=clients,
            action_servers=action_servers,
            action_clients=action_clients,
            parameters=parameters,
            timers=timers,
            has_lifecycle=node.style == "lifecycle" and contract,
            exercises_topics=of_topics,
            exercises_services=of_services,
            exercises_actions=of_actions,
            profiles=bool(publishers or subscriptions or services or clients),
            overrides=notes or (of_actions and bool(action_servers)),
            notes=notes,
        )
        return self._with_imports(found)

    def _with_imports(self, tests: NodeTests) -> NodeTests:
        imports = self._imports
        for is_used, names in _names_used(tests):
            if is_used:
                imports(*names)
        if tests.strategies:
            imports.add("hypothesis", "strategies", "st")
        for module in self._strategies.imports:
            imports.add("", module, module)
        return replace(
            tests,
            standard_imports=imports.statements(standard=True),
            imports=imports.statements(standard=False),
        )

    def _has(self, group: str) -> bool:
        return self._node.tests is None or group in self._node.tests

    def _node_class(self) -> str:
        name = self._node.node_class
        spelling = "NodeUnderTest" if name in _HOME or name in _OWN else name
        module = self._node.business_file.removesuffix(".py").replace("/", ".")
        self._imports.add(f"{self._node.package}.{module}", name, spelling)
        return spelling

    def _topic(self, endpoint: Endpoint) -> TopicText:
        members = self._members.of(endpoint)
        return TopicText(
            name=quoted(endpoint.name),
            type_name=quoted(endpoint.type_name),
            message=self._strategies.interface(endpoint.type_name),
            qos=self._profile(endpoint),
            method=quoted(members.methods[0]),
            attribute=quoted(members.attribute),
            messages=self._strategies.message(self._registry.message(endpoint.type_name)),
        )

    def _profile(self, endpoint: Endpoint) -> str:
        if endpoint.qos is None:
            return "None"
        return f"{self._imports('QoSProfile')}({', '.join(arguments(endpoint.qos, self._imports))})"

    def _service(self, endpoint: Endpoint) -> ServiceText:
        members = self._members.of(endpoint)
        service = self._registry.interface(endpoint.type_name)
        assert isinstance(service, Service)
        return ServiceText(
            name=quoted(endpoint.name),
            type_name=quoted(endpoint.type_name),
            service=self._strategies.interface(endpoint.type_name),
            qos=self._profile(endpoint),
            method=quoted(members.methods[0]),
            attribute=quoted(members.attribute),
            requests=self._strategies.message(service.request),
            responses=self._strategies.message(service.response),
        )

    def _action(self, endpoint: Endpoint) -> ActionText:
        members = self._members.of(endpoint)
        action = self._registry.interface(endpoint.type_name)
        assert isinstance(action, Action)
        return ActionText(
            name=quoted(endpoint.name),
            type_name=quoted(endpoint.type_name),
            action=self._strategies.interface(endpoint.type_name),
            methods=f"({', '.join(map(quoted, members.methods))}{',' * (len(members.methods) == 1)})",
            attribute=quoted(members.attribute),
            goals=self._strategies.message(action.goal),
            feedback=self._strategies.message(action.feedback),
            results=self._strategies.message(action.result),
        )

    def _parameter(self, parameter: Parameter) -> ParameterText:
        default = _start_value(parameter)
        kind = f"{KINDS[parameter.type.base]}{'_ARRAY' if parameter.type.array else ''}"
        texts = [quoted(parameter.name), f"{self._imports('Parameter')}.Type.{kind}"]
        texts.append("None" if default is None else literal(default))
        for values in (accepted(parameter), refused(parameter)):
            texts.append(f"[{', '.join(map(literal, values))}]")
        if parameter.description:
            texts.append(f"description={quoted(parameter.description)}")
        if parameter.additional_constraints:
            texts.append(f"constraints={quoted(parameter.additional_constraints)}")
        if parameter.read_only:
            texts.append("read_only=True")
        for validator in parameter.validators:
            if validator.name == "bounds" and not parameter.type.array:
                texts.append(f"range=({', '.join(map(literal, validator.arguments))})")
        return ParameterText(tuple(texts))

    def _timer(self, clockwork: Clockwork) -> TimerText:
        timer = clockwork.timer
        return TimerText(
            method=quoted(clockwork.method),
            period=repr(period_of(timer, self._node)),
            in_ros_time=repr(timer.clock == "ros" and not is_clock(self._node)),
            publishes=tuple(map(self._published, clockwork.publishers)),
        )

    def _published(self, endpoint: Endpoint) -> str:
        assert endpoint.qos is not None
        texts = [
            quoted(self._members.of(endpoint).methods[0]),
            self._strategies.interface(endpoint.type_name),
            quoted(endpoint.name),
            self._profile(endpoint),
            repr(endpoint.qos.deadline_ns / 1e9),
        ]
        return f"({', '.join(texts)})"


def _names_used(tests: NodeTests) -> Iterator[tuple[object, tuple[str, ...]]]:
    """What the templates of tests use, behind what it depends on."""
    topics = tests.publishers or tests.subscriptions
    services = tests.services or tests.clients
    actions = tests.action_servers or tests.action_clients
    yield True, ("Any", "Parameter")
    yield tests.strategies, ("HealthCheck", "Phase", "configuration", "settings")
    yield tests.strategies, ("Iterator", "Path", "TypeAlias", "os", "tempfile")
    yield topics or services, ("Callable", "Duration", "QoSProfile", "dataclass")
    yield tests.exercises_topics and topics, ("given", "partial")
    yield tests.exercises_services and services, ("given",)
    yield actions, ("Callable", "dataclass")
    yield tests.action_servers, ("get_action_server_names_and_types_by_node",)
    yield tests.action_clients, ("get_action_client_names_and_types_by_node",)
    if tests.exercises_actions:
        yield actions, ("CancelResponse", "Future", "GoalResponse", "GoalStatus", "given", "partial")
        yield tests.action_servers, ("ActionClient",)
        yield tests.action_clients, ("ActionServer",)
    yield tests.parameters, ("array", "attrgetter", "dataclass", "re")
    yield tests.timers, ("Callable", "QoSProfile", "dataclass", "find_spec", "pairwise", "partial", "time")
    yield tests.notes, ("deepcopy",)
    yield tests.is_managed, ("TransitionCallbackReturn",)
    yield tests.has_lifecycle, ("GetState",)
    yield tests.has_lifecycle and tests.publishers, ("partial",)


def given_at_start(node: NodeDescription) -> tuple[tuple[str, str], ...]:
    """The parameters without a default, and values to start with, as literals."""
    return tuple(
        (quoted(parameter.name), literal(value))
        for parameter in declared(node)
        if parameter.default is None and (value := _start_value(parameter)) is not None
    )


def is_clock(node: NodeDescription) -> bool:
    """Whether a node is the clock of others: its own ROS time is the system's."""
    return any(publisher.name == "/clock" for publisher in node.publishers)


def period_of(timer: Timer, node: NodeDescription) -> float:
    """The period of a timer at start, in seconds."""
    if timer.period is not None:
        return timer.period
    [parameter] = [p for p in node.parameters if p.name == timer.period_parameter]
    value = _start_value(parameter)
    assert isinstance(value, int | float)
    return float(value)


def _start_value(parameter: Parameter) -> ParameterValue | None:
    """The value of a parameter at start: its default, or one to give it."""
    return parameter.default if parameter.default is not None else next(iter(accepted(parameter)), None)
