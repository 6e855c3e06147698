"""Three definitions of one message, and nodes that exchange them."""

from __future__ import annotations

import contextlib
from typing import Any

import rclpy
from ifgen.dynamic import class_from_text
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile

LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
Message = Any
nodes: list[Node] = []  # of the present test: what nobody holds leaves the graph

SPEED = "demo_msgs/msg/Speed"
Old = class_from_text(SPEED, "float32 value")
New = class_from_text(SPEED, "float64 value\nstring source")
Longer = class_from_text(SPEED, "float64 value\nstring source\nuint8[] rest")


def upgrade(old: Message) -> Message:
    assert type(old) is Old
    return New(value=old.value, source="adapted")


def node(name: str, policy: str = "", **arguments: Any) -> Node:
    """A node with a policy of its own."""
    overrides = [Parameter("on_type_mismatch", value=policy)] if policy else []
    made = Node(name, parameter_overrides=overrides, **arguments)
    nodes.append(made)
    return made


def spin(receiver: Node, times: int = 8) -> None:
    for _ in range(times):
        rclpy.spin_once(receiver, timeout_sec=0)


def spin_until_shutdown(receiver: Node) -> None:
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(receiver)


def count(lines: list[str], text: str) -> int:
    return sum(text in line for line in lines)
