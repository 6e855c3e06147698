"""A program that looks at one node until the graph is quiet, asks for its parameters, and writes both down.

`ifgen nodl describe` runs it after the other programs, so that they end with it. It imports rclpy by name,
because the toolkit does not depend on rclpy: it uses the chosen transport.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ifgen.observing import node_observation
from ifgen.observing.graph_observer import settled
from ifgen.observing.node_observation import SeenParameter

_PATIENCE = 5.0  # s for the parameter services of a node to appear, and to answer each question


def main() -> None:
    """Look, ask, and write."""
    file, expected, *wanted = sys.argv[1:]
    rclpy: Any = import_module("rclpy")
    rclpy.init(args=[])
    # Hidden, as the command line tools of ROS are.
    node = rclpy.create_node("_ifgen_describe", start_parameter_services=False, enable_rosout=False)
    # Somebody else's node may take a while to be discovered; on the local transport there are none.
    is_real = find_spec("rmw_local") is None
    nodes, endpoints = settled(rclpy, node, int(expected) or int(is_real))
    chosen = node_observation.choose(nodes, next(iter(wanted), None))
    parameters = _parameters(rclpy, node, chosen) if chosen else None
    node_observation.write(Path(file), node_observation.Seen(nodes, endpoints, parameters))
    node.destroy_node()
    rclpy.try_shutdown()


def _parameters(rclpy: Any, node: Any, full_name: str) -> tuple[SeenParameter, ...] | None:
    """The parameters of a node; None if it has no parameter services or they do not answer."""
    client = import_module("rclpy.parameter_client").AsyncParameterClient(node, full_name)

    def answer(future: Any) -> Any:
        rclpy.spin_until_future_complete(node, future, timeout_sec=_PATIENCE)
        return future.result() if future.done() else None

    if not client.wait_for_services(timeout_sec=_PATIENCE):
        return None
    listed = answer(client.list_parameters([], 0))
    if listed is None:
        return None
    names = list(listed.result.names)
    if not names:
        return ()
    described = answer(client.describe_parameters(names))
    if described is None or len(described.descriptors) != len(names):
        return None

    def values(of_names: list[str]) -> list[Any]:
        response = answer(client.get_parameters(of_names))
        return list(response.values) if response else []

    found: list[Any] = values(names)
    if len(found) != len(names):  # one parameter without a value made the whole request fail
        found = [next(iter(values([name])), None) for name in names]
    return tuple(_parameter(*both) for both in zip(described.descriptors, found, strict=True))


def _parameter(descriptor: Any, value: Any) -> SeenParameter:
    """A parameter by its descriptor and its value, None if it has none."""
    type_ = node_observation.TYPES.get(value.type) if value else None
    type_ = type_ or node_observation.TYPES.get(descriptor.type)
    ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
    return SeenParameter(
        name=descriptor.name,
        type=type_ or "none",
        value=_value(value) if value else None,
        description=descriptor.description,
        read_only=descriptor.read_only,
        additional_constraints=descriptor.additional_constraints,
        bounds=(ranges[0].from_value, ranges[0].to_value) if ranges else None,
        step=ranges[0].step if ranges else 0,
    )


def _value(value: Any) -> Any:
    """The value of an rcl_interfaces/ParameterValue in plain Python; None if it is not set."""
    match node_observation.TYPES.get(value.type):
        case None:
            return None
        case "int":
            return value.integer_value
        case "int_array":
            return list(value.integer_array_value)
        case "byte_array":
            return [byte[0] if isinstance(byte, bytes) else byte for byte in value.byte_array_value]
        case type_:
            found = getattr(value, f"{type_}_value")
            return list(found) if type_.endswith("_array") else found


if __name__ == "__main__":
    main()
