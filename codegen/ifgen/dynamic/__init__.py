"""Classes of types that are known at run time only: from a type description, or from a definition's text.

    import ifgen.dynamic

    found = ifgen.dynamic.describe(node, "/odometry")
    Odometry = ifgen.dynamic.class_of(found)
    node.create_subscription(Odometry, "/odometry", callback, 10)

    Speed = ifgen.dynamic.class_from_text("my_msgs/msg/Speed", "float64 value 0.1  # [m/s]")

The classes are those that `ifgen generate` would write, made in memory: with the same metaclass, codec and
type hash, for the local transport and for real rclpy. Several versions of a type can exist side by side,
beside the generated class too. Errors are InputError, with one sentence for each mistake.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from ifgen.diagnostics import InputError
from ifgen.dynamic.texts import DescribeError, TypeDescription, class_from_text, class_of

if TYPE_CHECKING:
    from ifgen_tools.type_descriptions import describe, describe_action, describe_service

__all__ = [
    "DescribeError",
    "InputError",
    "TypeDescription",
    "class_from_text",
    "class_of",
    "describe",
    "describe_action",
    "describe_service",
]

_OF_TOOLS = {"describe", "describe_action", "describe_service"}
"""The functions that ask running nodes: they need an rclpy, and ifgen has none."""


def __getattr__(name: str) -> object:
    if name not in _OF_TOOLS:
        raise AttributeError(f"module 'ifgen.dynamic' has no attribute {name!r}")
    return getattr(import_module("ifgen_tools.type_descriptions"), name)
