"""`ifgen param describe`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ifgen_tools.graph.lookup import find_node
from ifgen_tools.param.remote import TYPES, RemoteParameters
from ifgen_tools.session import TransportChoice, open_session

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor


def describe_parameters(
    *,
    node: str,
    names: Sequence[str],
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    patience: float | None = None,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print descriptors."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteParameters(session, find_node(session, node, spin_time), patience)
        known = remote.names()
        for name in names:
            if name not in known:
                raise remote.missing(name)
        found = remote.descriptors(names)
    if as_json:
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
