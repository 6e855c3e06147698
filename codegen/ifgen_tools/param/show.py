"""`ifgen param list`, `get`, `describe` and `dump`."""

from __future__ import annotations

import json
import re
import sys
from array import array
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click
from ifgen.command_kit.tool import ToolError
from ifgen_runtime.parameters import parameter_yaml

from ifgen_tools.param.client import (
    BYTES,
    FIELDS,
    TYPES,
    RemoteParameters,
    json_value,
    remote_parameters,
    value_of,
)
from ifgen_tools.param.options import DescribeOptions, GetOptions, ParamListOptions
from ifgen_tools.ros_graph import node_names
from ifgen_tools.session import Session, find_node, open_session
from ifgen_tools.verbs import NodeOptions

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor, ParameterValue


@contextmanager
def opened(chosen: NodeOptions) -> Generator[RemoteParameters]:
    """The parameters of the node that the user named. Raises ToolError if it is not there."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        node = find_node(session, chosen.node, chosen.spin_time)
        with remote_parameters(session, node, chosen.patience) as remote:
            yield remote


def list_parameters(chosen: ParamListOptions) -> int:
    """Print the names of the parameters of a node, or of all nodes that have services for them."""
    matches = _compiled(chosen.pattern)
    code, found = 0, dict[str, Any]()
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        if chosen.node is None:
            session.discover(chosen.spin_time)
            nodes = _nodes_with_parameters(session, chosen.include_hidden)
        else:
            nodes = [find_node(session, chosen.node, chosen.spin_time)]
        for node in nodes:
            try:
                found[node] = _listed(session, node, chosen, matches)
            except ToolError as error:
                if chosen.node is not None:
                    raise
                code = 1  # the others are shown nevertheless
                print(f"error: {error.message}", file=sys.stderr)
                continue
            if not chosen.as_json:
                _print_list(node if chosen.node is None else None, found[node])
    if chosen.as_json:
        print(json.dumps(found, indent=2))
    return code


def _listed(
    session: Session, node: str, chosen: ParamListOptions, matches: re.Pattern[str]
) -> dict[str, str] | list[str]:
    """The parameters of a node to list, with the names of their types if these are wanted."""
    with remote_parameters(session, node, chosen.patience) as remote:
        names = [name for name in remote.names(chosen.param_prefixes) if matches.match(name)]
        if not chosen.with_types:
            return names
        types = remote.types(names)
        return {name: TYPES[types[name]] for name in names if name in types}


def _compiled(pattern: str | None) -> re.Pattern[str]:
    try:
        return re.compile(pattern or "")
    except re.error as error:
        raise click.UsageError(f"--filter {pattern!r} is no regular expression: {error}") from None


def _nodes_with_parameters(session: Session, include_hidden: bool) -> list[str]:
    services = {name for name, _ in session.node.get_service_names_and_types()}
    return [
        name for name in node_names(session.node, include_hidden) if f"{name}/list_parameters" in services
    ]


def _print_list(heading: str | None, found: dict[str, str] | list[str]) -> None:
    if heading is not None and found:
        print(f"{heading}:")
    for name in found:
        print(f"  {name} (type: {found[name]})" if isinstance(found, dict) else f"  {name}")


def get_parameter(chosen: GetOptions) -> int:
    """Print a value, after the name of its type."""
    with opened(chosen) as remote:
        found = remote.values([chosen.name])
        if chosen.name not in found:
            raise remote.missing(chosen.name)
    message = found[chosen.name]
    kind = TYPES[message.type]
    if chosen.as_json:
        parts = {"node": remote.node, "name": chosen.name, "type": kind, "value": json_value(message)}
        print(json.dumps(parts))
    elif message.type not in FIELDS:
        print("None" if chosen.hide_type else "Parameter not set.")
    else:
        print(_text(message) if chosen.hide_type else f"{_label(message.type)} {_text(message)}")
    return 0


def _label(type_: int) -> str:
    """The words that ROS writes before a value: `Integer value is:`, `Double values are:`."""
    kind, *is_array = TYPES[type_].capitalize().split()
    return f"{kind} values are:" if is_array else f"{kind} value is:"


def _text(message: ParameterValue) -> str:
    """A value as `ros2 param get` prints it, which is as Python does."""
    value: Any = getattr(message, FIELDS[message.type])
    # Our messages have arrays where those of rosidl have arrays, and both print these alike.
    return str(value if isinstance(value, array) else list(value) if message.type >= BYTES else value)


def describe_parameters(chosen: DescribeOptions) -> int:
    """Print descriptors."""
    with opened(chosen) as remote:
        known = remote.names()
        for name in chosen.names:
            if name not in known:
                raise remote.missing(name)
        found = remote.descriptors(chosen.names)
    if chosen.as_json:
        print(json.dumps([_plain(descriptor) for descriptor in found], indent=2))
    else:
        for descriptor in found:
            print(*_lines(descriptor), sep="\n")
    return 0


def _lines(descriptor: ParameterDescriptor) -> Iterator[str]:
    """The lines of a descriptor as ROS prints them."""
    yield f"Parameter name: {descriptor.name}"
    yield f"  Type: {TYPES[descriptor.type]}"
    if descriptor.description:
        yield f"  Description: {descriptor.description}"
    yield "  Constraints:"
    if descriptor.read_only:
        yield "    Read only: true"
    if limits := _limits(descriptor):
        yield f"    Min value: {limits['min']}"
        yield f"    Max value: {limits['max']}"
        if limits["step"]:
            yield f"    Step: {limits['step']}"
    if descriptor.additional_constraints:
        yield f"    Additional constraints: {descriptor.additional_constraints}"


def _limits(descriptor: ParameterDescriptor) -> dict[str, Any] | None:
    """The range of numbers, of which a descriptor has one at most."""
    limits: Any
    for limits in (*descriptor.floating_point_range, *descriptor.integer_range):
        return {"min": limits.from_value, "max": limits.to_value, "step": limits.step}
    return None


def _plain(descriptor: ParameterDescriptor) -> dict[str, Any]:
    return {
        "name": descriptor.name,
        "type": TYPES[descriptor.type],
        "description": descriptor.description,
        "additional_constraints": descriptor.additional_constraints,
        "read_only": descriptor.read_only,
        "dynamic_typing": descriptor.dynamic_typing,
        "range": _limits(descriptor),
    }


def dump_parameters(chosen: NodeOptions) -> int:
    """Print all parameters of a node in the form of a parameter file."""
    with opened(chosen) as remote:
        found = remote.values(remote.names())
    values = {name: value for name, value in found.items() if value.type}  # the others have none
    if chosen.as_json:
        tree = parameter_yaml.nested({name: json_value(value) for name, value in values.items()})
        print(json.dumps({remote.node: {parameter_yaml.PARAMETERS_KEY: tree}}, indent=2))
    else:
        plain = {name: value_of(value) for name, value in values.items()}
        print(parameter_yaml.file_text(remote.node, plain))
    return 0
