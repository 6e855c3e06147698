"""From the description of a node to the file of tests that is the user's: one test, to go on from."""

from __future__ import annotations

from array import array
from dataclasses import replace

from ifgen.definition.interfaces import Action, Interface, Message, Registry, Service
from ifgen.definition.types import NamespacedType, element_of
from ifgen.generator_py.imports import IN_NODES, Names
from ifgen.generator_py.messages.fields import default_value, is_float32
from ifgen.generator_py.nodes.members import Clockwork, members_of, references
from ifgen.generator_py.tests.context import OwnTests
from ifgen.generator_py.tests.contract import given_at_start, is_clock, period_of
from ifgen.generator_py.text import are_long, quoted
from ifgen.nodl.model import Endpoint, NodeDescription


def own_tests(node: NodeDescription, registry: Registry) -> OwnTests:
    """The file with a test of the first thing that a new node does."""
    writer = _Writer(node, registry)
    publishing = [timer for timer in members_of(node).timers if timer.publishers]
    if publishing:
        tests = writer.of_publisher(publishing[0])
    elif node.service_servers:
        tests = writer.of_service(node.service_servers[0])
    elif node.action_servers:
        tests = writer.of_action(node.action_servers[0])
    else:
        tests = writer.of_start()
    names = (tests.method, tests.endpoint, tests.interface, tests.qos, tests.timer, node.node_class)
    return replace(tests, imports=writer.imports.lines, has_long_names=are_long(names))


class _Writer:
    """The possible subjects of one node's first test; `imports` are those of the texts made so far."""

    def __init__(self, node: NodeDescription, registry: Registry) -> None:
        self.imports = Names(IN_NODES)
        self._node = node
        self._registry = registry
        self._members = members_of(node)

    def of_start(self, *, use_sim_time: bool = True) -> OwnTests:
        """A node that runs."""
        node = self._node
        module = node.business_file.removesuffix(".py").replace("/", ".")
        self.imports.add(f"{node.package}.{module}", node.node_class)
        arguments = [node.node_class]
        for name, value in given_at_start(node):
            arguments.append(f"{self.imports('Parameter')}({name}, value={value})")
        if is_clock(node) or not use_sim_time:
            arguments.append("use_sim_time=False")
        return OwnTests(
            name=node.name,
            imports=(),
            kind="start",
            method="start",
            arguments=", ".join(arguments),
            is_managed=node.style == "lifecycle",
            endpoint=quoted(node.name),
        )

    def of_publisher(self, clockwork: Clockwork) -> OwnTests:
        """The first message that a timer publishes."""
        publisher = clockwork.publishers[0]
        return replace(
            self._of(publisher, self._members.of(publisher).methods[0], self.of_start()),
            kind="publisher",
            timer=clockwork.attribute,
            period=repr(period_of(clockwork.timer, self._node)),
            in_ros_time=clockwork.timer.clock == "ros" and not is_clock(self._node),
        )

    def of_service(self, service: Endpoint) -> OwnTests:
        """The response to a request."""
        # An answer may take time, which would stand still.
        start = self.of_start(use_sim_time=False)
        return replace(self._of(service, self._members.of(service).methods[0], start), kind="service")

    def of_action(self, action: Endpoint) -> OwnTests:
        """The result of a goal."""
        start = self.of_start(use_sim_time=False)
        return replace(self._of(action, self._members.of(action).methods[-1], start), kind="action")

    def _of(self, endpoint: Endpoint, method: str, start: OwnTests) -> OwnTests:
        """The first effect of an endpoint."""
        interface = references(self._node)[endpoint.type_name]
        package, folder, name = endpoint.type_name.split("/")
        self.imports.add(f"{package}.{folder}", name, interface)
        message, part = _first_answer(self._registry.interface(endpoint.type_name))
        expected = f"{interface}{part}()"
        qos = self._members.of(endpoint).constant if endpoint.qos else ""
        if qos:
            self.imports.add(f"{self._node.package}._{self._node.name}_base", qos)
        return replace(
            start,
            method=method,
            endpoint=quoted(endpoint.name),
            interface=interface,
            qos=qos,
            expected=expected if _survives(message, self._registry) else f"ros.received({expected})",
        )


def _first_answer(interface: Interface) -> tuple[Message, str]:
    """The first message of a new node, and the place of that endpoint's own class in its interface."""
    match interface:
        case Message():
            return interface, ""
        case Service(response=response):
            return response, ".Response"
        case Action(result=result):
            return result, ".Result"


def _survives(message: Message, registry: Registry) -> bool:
    """True if a new message is received unchanged; one with a float32 of 0.1 by default is not."""
    for field in message.fields:
        element = element_of(field.type)
        value = default_value(field)
        if isinstance(element, NamespacedType):
            if not _survives(registry.message(element.type_name), registry):
                return False
        elif is_float32(field.type) and isinstance(value, float) and array("f", [value])[0] != value:
            return False
    return True
