"""From the description of a node to what its two classes are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ifgen.generator_py.docstrings import docstring
from ifgen.generator_py.node_context import (
    ActionClientText,
    ActionServerText,
    ClientText,
    NodeModule,
    PublisherText,
    ServiceText,
    SubscriptionText,
    TimerText,
)
from ifgen.generator_py.nodes.imports import Imports
from ifgen.generator_py.nodes.members import Clockwork, members_of
from ifgen.generator_py.nodes.parameters import declared
from ifgen.generator_py.nodes.qos import profile
from ifgen.generator_py.nodes.text import are_long, literal, quoted, signature
from ifgen.nodl.model import Endpoint, NodeDescription

_CLOCKS = {"ros": "", "steady": "STEADY_TIME", "system": "SYSTEM_TIME"}
_CLIENT_TIMEOUT = "timeout_sec: float = 5.0"


class NodeTexts:
    """The texts of one node's endpoints and timers, for a module whose imports it collects on the way."""

    def __init__(self, node: NodeDescription, imports: Imports) -> None:
        self._node = node
        self._imports = imports
        self._members = members_of(node)
        self._awaits = node.style == "asyncio"
        self.publishers = tuple(map(self._publisher, node.publishers))
        self.subscriptions = tuple(map(self._subscription, node.subscriptions))
        self.services = tuple(map(self._service, node.service_servers))
        self.clients = tuple(map(self._client, node.service_clients))
        self.action_servers = tuple(map(self._action_server, node.action_servers))
        self.action_clients = tuple(map(self._action_client, node.action_clients))
        self.timers = tuple(map(self._timer, self._members.timers))

    def names(self) -> Iterator[str]:
        """The names that stand on one line with more than one other."""
        yield self._node.node_class
        for endpoint in self._node.endpoints:
            yield self._members.of(endpoint).attribute
            yield self._imports.interface(endpoint.type_name)
            yield endpoint.name
        yield from (timer.attribute for timer in self.timers)

    def profiles(self) -> tuple[tuple[str, str], ...]:
        """The constants of all QoS profiles, and the calls that make them."""
        return tuple(
            (self._members.of(endpoint).constant, profile(endpoint.qos, self._imports))
            for endpoint in self._node.endpoints
            if endpoint.qos
        )

    def _publisher(self, endpoint: Endpoint) -> PublisherText:
        members = self._members.of(endpoint)
        message = self._imports.interface(endpoint.type_name)
        return PublisherText(
            attribute=members.attribute,
            publish=members.methods[0],
            signature=signature(members.methods[0], [f"message: {message}"], "None"),
            message=message,
            topic=quoted(endpoint.name),
            qos=members.constant,
            documentation=_documentation(endpoint),
            docstring=_docstring(f"Publish on `{endpoint.name}`.", endpoint),
            once=endpoint in self._members.once,
        )

    def _subscription(self, endpoint: Endpoint) -> SubscriptionText:
        members = self._members.of(endpoint)
        message = self._imports.interface(endpoint.type_name)
        return SubscriptionText(
            attribute=members.attribute,
            callback=members.methods[0],
            signature=self._signature(members.methods[0], [f"message: {message}"], "None"),
            message=message,
            topic=quoted(endpoint.name),
            qos=members.constant,
            documentation=_documentation(endpoint),
            docstring=_docstring(f"Take a message from `{endpoint.name}`.", endpoint),
            log=quoted(f"message on {endpoint.name}"),
        )

    def _service(self, endpoint: Endpoint) -> ServiceText:
        members = self._members.of(endpoint)
        service = self._imports.interface(endpoint.type_name)
        parameters = [f"request: {service}.Request", f"response: {service}.Response"]
        return ServiceText(
            attribute=members.attribute,
            callback=members.methods[0],
            signature=self._signature(members.methods[0], parameters, f"{service}.Response"),
            service=service,
            name=quoted(endpoint.name),
            qos=members.constant if endpoint.qos else "",
            documentation=_documentation(endpoint),
            docstring=_docstring(f"Answer a request to `{endpoint.name}`.", endpoint),
        )

    def _client(self, endpoint: Endpoint) -> ClientText:
        members = self._members.of(endpoint)
        service = self._imports.interface(endpoint.type_name)
        parameters, result = [f"request: {service}.Request"], "Future"
        text = f"Send a request to `{endpoint.name}`; the future completes with the response."
        if self._awaits:
            parameters, result = [*parameters, "*", _CLIENT_TIMEOUT], f"{service}.Response"
            text = f"Call `{endpoint.name}`. TimeoutError without a response within `timeout_sec` [s]."
        return ClientText(
            attribute=members.attribute,
            call=members.methods[0],
            signature=self._signature(members.methods[0], parameters, result),
            service=service,
            name=quoted(endpoint.name),
            qos=members.constant if endpoint.qos else "",
            documentation=_documentation(endpoint),
            docstring=_docstring(text, endpoint),
        )

    def _action_server(self, endpoint: Endpoint) -> ActionServerText:
        members = self._members.of(endpoint)
        accept, cancel, execute = members.methods
        action = self._imports.interface(endpoint.type_name)
        handle = ["goal_handle: ServerGoalHandle"]
        return ActionServerText(
            attribute=members.attribute,
            accept=accept,
            accept_signature=self._signature(accept, [f"goal: {action}.Goal"], "GoalResponse"),
            cancel=cancel,
            cancel_signature=self._signature(cancel, handle, "CancelResponse"),
            execute=execute,
            execute_signature=self._signature(execute, handle, f"{action}.Result"),
            action=action,
            name=quoted(endpoint.name),
            documentation=_documentation(endpoint),
            accept_docstring=_docstring(f"Decide whether to accept a goal for `{endpoint.name}`."),
            cancel_docstring=_docstring(f"Decide whether a goal of `{endpoint.name}` may be cancelled."),
            execute_docstring=_docstring(f"Execute a goal of `{endpoint.name}`.", endpoint),
        )

    def _action_client(self, endpoint: Endpoint) -> ActionClientText:
        members = self._members.of(endpoint)
        action = self._imports.interface(endpoint.type_name)
        parameters = [
            f"goal: {action}.Goal",
            f"feedback: Callable[[{action}.Feedback], object] | None = None",
        ]
        result = "Future"
        text = f"Send a goal to `{endpoint.name}`; the future completes with a ClientGoalHandle."
        if self._awaits:
            parameters = [parameters[0], "*", _CLIENT_TIMEOUT]
            result = f"RunningGoal[{action}.Feedback, {action}.Result]"
            text = (
                f"Send a goal to `{endpoint.name}`, and wait until it is accepted. GoalRejected if not; "
                "TimeoutError without an answer within `timeout_sec` [s]."
            )
        return ActionClientText(
            attribute=members.attribute,
            send=members.methods[0],
            signature=self._signature(members.methods[0], parameters, result),
            action=action,
            name=quoted(endpoint.name),
            documentation=_documentation(endpoint),
            docstring=_docstring(text, endpoint),
        )

    def _timer(self, clockwork: Clockwork) -> TimerText:
        timer = clockwork.timer
        parameter = next((p for p in self._node.parameters if p.name == timer.period_parameter), None)
        if parameter is None:
            assert timer.period is not None
            period, how_often = literal(timer.period), f"every {timer.period:g} s"
        else:
            period, how_often = f"self.parameters.{parameter.name}", f"every `{parameter.name}` [s]"
        return TimerText(
            attribute=clockwork.attribute,
            callback=clockwork.method,
            signature=self._signature(clockwork.method, [], "None"),
            period=period,
            clock=_CLOCKS[timer.clock],
            follows=parameter is not None and not parameter.read_only,
            docstring=_docstring(f"Called {how_often}."),
            log=quoted(f"timer {timer.name}"),
            publishes=tuple(p for p in self.publishers if p.topic in map(quoted, timer.publishes)),
        )

    def _signature(self, name: str, parameters: list[str], result: str) -> str:
        return signature(name, parameters, result, is_async=self._awaits)


def base_module(node: NodeDescription) -> NodeModule:
    """What `_name_base.py` is made of."""
    imports = Imports(node)
    texts = NodeTexts(node, imports)
    module = _module(node, texts, f"Base of the node {node.name}: generated by ifgen, do not edit.")
    profiles = texts.profiles()
    _import_for_base(node, module, imports)
    return replace(module, imports=imports.lines, profiles=profiles)


def user_module(node: NodeDescription) -> NodeModule:
    """What the user's module is made of when it is written."""
    imports = Imports(node)
    # The base alone needs the interfaces of clients.
    texts = NodeTexts(node, Imports(node))
    module = _module(node, texts, f"The node {node.name}: written once by ifgen, yours from then on.")
    _import_for_user(node, module, imports)
    return replace(module, imports=imports.lines)


def _module(node: NodeDescription, texts: NodeTexts, title: str) -> NodeModule:
    has_parameters = bool(declared(node))
    is_abstract = bool(texts.subscriptions or texts.services or texts.action_servers or texts.timers)
    options = docstring("Take the options of `rclpy.node.Node`.", indent=8)
    if has_parameters:
        options = docstring(
            "Take the options of `rclpy.node.Node`. Raises ParametersError for parameters that break rules.",
            indent=8,
        )
    return NodeModule(
        name=quoted(node.name),
        plain_name=node.name,
        style=node.style,
        title=title,
        docstring=docstring(node.description or f"The node {node.name}.", indent=4),
        imports=(),
        node_class=node.node_class,
        base_class=f"{node.node_class}Base",
        bases=_node_class(node) + (", ABC" if is_abstract else ""),
        parameters_class=f"{node.node_class}Parameters",
        has_parameters=has_parameters,
        needs_group=bool(node.action_servers)
        or (node.style == "asyncio" and len(node.endpoints) > len(node.publishers)),
        in_threads=bool(node.action_servers) and node.style != "asyncio",
        sends_once=any(publisher.once for publisher in texts.publishers),
        has_long_names=are_long(texts.names()),
        constructor_docstring=options,
        attributes=tuple(_attributes(node, texts)),
        profiles=(),
        publishers=texts.publishers,
        subscriptions=texts.subscriptions,
        services=texts.services,
        clients=texts.clients,
        action_servers=texts.action_servers,
        action_clients=texts.action_clients,
        timers=texts.timers,
    )


def _node_class(node: NodeDescription) -> str:
    return "LifecycleNode" if node.style == "lifecycle" else "Node"


def _publisher_class(node: NodeDescription) -> str:
    return "LifecyclePublisher" if node.style == "lifecycle" else "Publisher"


def _attributes(node: NodeDescription, texts: NodeTexts) -> Iterator[tuple[str, str, str]]:
    """Name, annotation and docstring of every entity."""
    for publisher in texts.publishers:
        yield publisher.attribute, f"{_publisher_class(node)}[{publisher.message}]", publisher.documentation
    for subscription in texts.subscriptions:
        yield subscription.attribute, f"Subscription[{subscription.message}]", subscription.documentation
    for service in texts.services:
        yield service.attribute, "Service", service.documentation
    for client in texts.clients:
        yield client.attribute, "Client", client.documentation
    for server in texts.action_servers:
        yield server.attribute, "ActionServer", server.documentation
    for action_client in texts.action_clients:
        yield action_client.attribute, "ActionClient", action_client.documentation
    for timer in texts.timers:
        yield timer.attribute, "Timer", docstring(f"Calls `{timer.callback}`.", indent=4)


def _import_for_base(node: NodeDescription, module: NodeModule, imports: Imports) -> None:
    awaits, is_managed = node.style == "asyncio", node.style == "lifecycle"
    used = {
        "Any": True,
        _node_class(node): True,
        "ABC": module.bases.endswith("ABC"),
        "abstractmethod": module.bases.endswith("ABC"),
        _publisher_class(node): module.publishers,
        "Subscription": module.subscriptions,
        "Service": module.services,
        "Client": module.clients,
        "ActionServer": module.action_servers,
        "ActionClient": module.action_clients,
        "Timer": module.timers,
        "Future": (module.clients or module.action_clients) and not awaits,
        "Callable": module.action_clients and not awaits,
        "ReentrantCallbackGroup": module.needs_group,
        "MutuallyExclusiveCallbackGroup": module.timers and awaits,
        "CancelResponse": module.action_servers,
        "GoalResponse": module.action_servers,
        "ServerGoalHandle": module.action_servers,
        "Clock": any(timer.clock for timer in module.timers),
        "ClockType": any(timer.clock for timer in module.timers),
        "Parameter": module.has_parameters,
        "ExitStack": is_managed,
        "LifecycleState": is_managed,
        "TransitionCallbackReturn": is_managed,
    }
    for name, is_used in used.items():
        if is_used:
            imports(name)
    if module.has_parameters:
        names = (module.parameters_class, "declare_parameters", "read_parameters")
        imports.own(f"_{node.name}_parameters", *names)
    if awaits:
        imports.own("_waiting", "sleep")
        imports.own("_waiting", *(("call",) if module.clients else ()))
        imports.own("_waiting", *(("RunningGoal", "send") if module.action_clients else ()))


def _import_for_user(node: NodeDescription, module: NodeModule, imports: Imports) -> None:
    is_managed = node.style == "lifecycle" and module.sends_once
    used = {
        "Any": True,
        "rclpy": True,
        "ExternalShutdownException": True,
        "MultiThreadedExecutor": module.in_threads,
        "CancelResponse": module.action_servers,
        "GoalResponse": module.action_servers,
        "ServerGoalHandle": module.action_servers,
        "LifecycleState": is_managed,
        "TransitionCallbackReturn": is_managed,
        "sys": module.has_parameters,
    }
    for name, is_used in used.items():
        if is_used:
            imports(name)
    for endpoint in (*node.publishers, *node.subscriptions, *node.service_servers, *node.action_servers):
        imports.interface(endpoint.type_name)
    imports.own(f"_{node.name}_base", module.base_class)
    if module.has_parameters:
        imports.own(f"_{node.name}_parameters", "ParametersError")


def _documentation(endpoint: Endpoint) -> str:
    text = f"{endpoint.description}\n\n" if endpoint.description else ""
    return docstring(f"{text}`{endpoint.name}`, {endpoint.type_name}.", indent=4)


def _docstring(text: str, endpoint: Endpoint | None = None) -> str:
    more = endpoint.description if endpoint else ""
    return docstring(f"{text}\n\n{more}" if more else text, indent=8)
