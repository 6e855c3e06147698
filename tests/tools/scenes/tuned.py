"""Parameters of each type: described, bounded, read-only, nested, and one that refuses what it does not like."""

from __future__ import annotations

import rclpy
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

from tests.tools.scenes.stage import play


def refuse(parameters: list[Parameter]) -> SetParametersResult:
    """Accept everything but "nobody" as `frame.name`."""
    bad = any(each.name == "frame.name" and each.value == "nobody" for each in parameters)
    return SetParametersResult(successful=not bad, reason="nobody is no frame" if bad else "")


def main() -> None:
    """Keep the parameters."""
    rclpy.init()
    node = Node("tuned", namespace="/demo")
    bounded = ParameterDescriptor(
        description="How fast [m/s].",
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.5, step=0.1)],
    )
    steps = ParameterDescriptor(
        integer_range=[IntegerRange(from_value=1, to_value=9, step=2)], additional_constraints="odd"
    )
    optional = ParameterDescriptor(type=ParameterType.PARAMETER_INTEGER, dynamic_typing=True)
    node.declare_parameter("speed", 0.1, bounded)
    node.declare_parameter("steps", 3, steps)
    node.declare_parameter("serial", "A-7", ParameterDescriptor(read_only=True))
    node.declare_parameter("frame.name", "map")
    node.declare_parameter("frame.offset", [0.1, 2.0, 1e-9])
    node.declare_parameter("frame.corners", [1, -2])
    node.declare_parameter("enabled", value=True)
    node.declare_parameter("flags", [True, False])
    node.declare_parameter("names", ["left", "it's right"])
    node.declare_parameter("raw", [b"\x01", b"\xff"])
    node.declare_parameter("optional", 5, optional)
    node.add_on_set_parameters_callback(refuse)
    play(node, Node("plain"))


if __name__ == "__main__":
    main()
