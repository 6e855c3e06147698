"""From the endpoints and timers of a node to the texts that its classes are made of."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.generator_py.nodes.context import (
    ActionClientText,
    ActionServerText,
    ClientText,
    PublisherText,
    ServiceText,
    SubscriptionText,
    TimerText,
)
from ifgen.generator_py.nodes.members import Clockwork, Imports, members_of, references
from ifgen.generator_py.text import docstring, literal, qos_profile, quoted, signature
from ifgen.nodl.model import Endpoint, NodeDescription

_CLOCKS = {"ros": "", "steady": "STEADY_TIME", "system": "SYSTEM_TIME"}
_CLIENT_TIMEOUT = "timeout_sec: float = 5.0"


class NodeTexts:
    """The texts of one node's endpoints and timers; they have imported what they name.

    The texts of clients import into `of_clients`, which may be the names of another module.
    """

    def __init__(self, node: NodeDescription, imports: Imports, of_clients: Imports) -> None:
        self._node = node
        self._imports = imports
        self._of_clients = of_clients
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
        yield from references(self._node).values()
        for endpoint in self._node.endpoints:
            yield self._members.of(endpoint).attribute
            yield endpoint.name
        yield from (timer.attribute for timer in self.timers)

    def profiles(self) -> tuple[tuple[str, str], ...]:
        """The constants of all QoS profiles, and the calls that make them."""
        return tuple(
            (self._members.of(endpoint).constant, qos_profile(endpoint.qos, self._imports))
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
        service = self._of_clients.interface(endpoint.type_name)
        parameters = [f"request: {service}.Request"]
        if self._awaits:
            parameters, result = [*parameters, "*", _CLIENT_TIMEOUT], f"{service}.Response"
            text = f"Call `{endpoint.name}`. TimeoutError without a response within `timeout_sec` [s]."
        else:
            result = f"{self._of_clients('Future')}[{service}.Response]"
            text = f"Send a request to `{endpoint.name}`; the future completes with the response."
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
        handle = [f"goal_handle: {self._imports('ServerGoalHandle')}[{action}]"]
        # In the style `nodl`, goals are accepted in the base.
        imports = self._of_clients if self._node.style == "nodl" else self._imports
        accepted, cancelled = imports("GoalResponse"), imports("CancelResponse")
        return ActionServerText(
            attribute=members.attribute,
            accept=accept,
            accept_signature=self._signature(accept, [f"goal: {action}.Goal"], accepted),
            cancel=cancel,
            cancel_signature=self._signature(cancel, handle, cancelled),
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
        imports = self._of_clients
        action = imports.interface(endpoint.type_name)
        parameters = [f"goal: {action}.Goal"]
        if self._awaits:
            parameters += ["*", _CLIENT_TIMEOUT]
            result = f"{imports.own('_waiting', 'RunningGoal')}[{action}.Feedback, {action}.Result]"
            text = (
                f"Send a goal to `{endpoint.name}`, and wait until it is accepted. GoalRejected if not; "
                "TimeoutError without an answer within `timeout_sec` [s]."
            )
        else:
            parameters.append(f"feedback: {imports('Callable')}[[{action}.Feedback], object] | None = None")
            result = f"{imports('Future')}[{imports('ClientGoalHandle')}[{action}]]"
            text = f"Send a goal to `{endpoint.name}`; the future completes with a ClientGoalHandle."
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


def _documentation(endpoint: Endpoint) -> str:
    text = f"{endpoint.description}\n\n" if endpoint.description else ""
    return docstring(f"{text}`{endpoint.name}`, {endpoint.type_name}.", indent=4)


def _docstring(text: str, endpoint: Endpoint | None = None) -> str:
    more = endpoint.description if endpoint else ""
    return docstring(f"{text}\n\n{more}" if more else text, indent=8)
