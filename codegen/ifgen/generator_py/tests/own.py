"""From the description of a node to the file of tests that is the user's: one test, to go on from."""

from __future__ import annotations

from array import array
from dataclasses import replace

from ifgen.definition.interfaces import Action, Interface, Message, Registry, Service
from ifgen.definition.types import CollectionType, NamespacedType
from ifgen.generator_py.imports import statements
from ifgen.generator_py.messages.fields import default_value, is_float32
from ifgen.generator_py.nodes.imports import references
from ifgen.generator_py.nodes.members import members_of
from ifgen.generator_py.nodes.text import are_long, quoted
from ifgen.generator_py.tests.context import OwnTests
from ifgen.generator_py.tests.contract import given_at_start, is_clock, period_of
from ifgen.nodl.model import Endpoint, NodeDescription


def own_tests(node: NodeDescription, registry: Registry) -> OwnTests:
    """The file with a test of the first thing that a new node does."""
    members = members_of(node)
    module = node.business_file.removesuffix(".py").replace("/", ".")
    imports = {(f"{node.package}.{module}", node.node_class, node.node_class)}
    arguments = [node.node_class]
    for name, value in given_at_start(node):
        arguments.append(f"Parameter({name}, value={value})")
        imports.add(("rclpy.parameter", "Parameter", "Parameter"))
    publishing = [timer for timer in members.timers if timer.publishers]
    answers = not publishing and (node.service_servers or node.action_servers)
    if is_clock(node) or answers:  # an answer may take time, which would stand still
        arguments.append("use_sim_time=False")
    tests = OwnTests(
        name=node.name,
        imports=(),
        kind="start",
        method="start",
        arguments=", ".join(arguments),
        is_managed=node.style == "lifecycle",
        endpoint=quoted(node.name),
    )

    def of(endpoint: Endpoint, method: str) -> OwnTests:
        interface = references(node)[endpoint.type_name]
        package, folder, name = endpoint.type_name.split("/")
        imports.add((f"{package}.{folder}", name, interface))
        message, part = _first_answer(registry.interface(endpoint.type_name))
        expected = f"{interface}{part}()"
        qos = members.of(endpoint).constant if endpoint.qos else ""
        if qos:
            imports.add((f"{node.package}._{node.name}_base", qos, qos))
        return replace(
            tests,
            method=method,
            endpoint=quoted(endpoint.name),
            interface=interface,
            qos=qos,
            expected=expected if _survives(message, registry) else f"ros.received({expected})",
        )

    if publishing:
        [clockwork, *_] = publishing
        publisher = clockwork.publishers[0]
        tests = replace(
            of(publisher, members.of(publisher).methods[0]),
            kind="publisher",
            timer=clockwork.attribute,
            period=repr(period_of(clockwork.timer, node)),
            in_ros_time=clockwork.timer.clock == "ros" and not is_clock(node),
        )
    elif node.service_servers:
        [service, *_] = node.service_servers
        tests = replace(of(service, members.of(service).methods[0]), kind="service")
    elif node.action_servers:
        [action, *_] = node.action_servers
        imports.add(("action_msgs.msg", "GoalStatus", "GoalStatus"))
        imports.add(("rclpy.action", "ActionClient", "ActionClient"))
        tests = replace(of(action, members.of(action).methods[-1]), kind="action")
    names = (tests.method, tests.endpoint, tests.interface, tests.qos, tests.timer, node.node_class)
    return replace(tests, imports=statements(imports), has_long_names=are_long(names))


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
        element = field.type.value_type if isinstance(field.type, CollectionType) else field.type
        value = default_value(field)
        if isinstance(element, NamespacedType):
            if not _survives(registry.message(element.type_name), registry):
                return False
        elif is_float32(field.type) and isinstance(value, float) and array("f", [value])[0] != value:
            return False
    return True
