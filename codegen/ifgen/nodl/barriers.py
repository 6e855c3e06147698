"""Code that exists already: classes that `codegen.python` names, and the parts of every node of rclpy.

A document with `codegen.python` stands for code that somebody wrote. What it and its includes declare is part
of the interface of a node that includes it, but nothing is generated for it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names
from ifgen.nodl.model import BaseClass, Category, Endpoint, Interface, Parameter
from ifgen.nodl.syntax.tree import Key, MapNode, Node, ScalarNode, plain_value, unknown_key

_BASES: Final = Path(__file__).parent / "bases"
_NODE: Final = _BASES / "node.nodl.yaml"
_LIFECYCLE_NODE: Final = _BASES / "lifecycle_node.nodl.yaml"
OFFICIAL: Final = {
    ("nodl_common_interfaces", "node"): _NODE,
    ("nodl_common_interfaces", "lifecycle_node"): _LIFECYCLE_NODE,
    # The names of earlier versions.
    ("rclcpp", "node"): _NODE,
    ("rclpy", "node"): _NODE,
    ("rclcpp_lifecycle", "lifecycle_node"): _LIFECYCLE_NODE,
    ("rclpy", "lifecycle_node"): _LIFECYCLE_NODE,
}
"""The base documents that come with ifgen, for where the package of the ROS project is not installed."""

NODE: Final = BaseClass("rclpy.node", "Node")
LIFECYCLE_NODE: Final = BaseClass("rclpy.lifecycle", "LifecycleNode", "create_lifecycle_publisher")
# What nodl_common_interfaces 2.0 registers has no `codegen.python`.
_OF_CPP: Final = {"rclcpp::Node": NODE, "rclcpp_lifecycle::LifecycleNode": LIFECYCLE_NODE}

_DOTTED: Final = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)
_CPP: Final = re.compile(r"[A-Za-z_]\w*(::[A-Za-z_]\w*)*", re.ASCII)
_KEYS: Final = {
    "python": {"role", "module", "class", "publisher_method"},
    "cpp": {"role", "class", "header", "publisher_type", "namespace"},
}
_ROLES: Final = {"python": ("BASE_CLASS", "NO_GENERATE"), "cpp": ("BASE_CLASS", "NO_GENERATE", "NODE")}

_TOPICS_OF_NODES: Final = {
    "rosout": "rcl_interfaces/msg/Log",
    "parameter_events": "rcl_interfaces/msg/ParameterEvent",
}
_SERVICES_OF_NODES: Final = {
    "describe_parameters": "rcl_interfaces/srv/DescribeParameters",
    "get_parameters": "rcl_interfaces/srv/GetParameters",
    "get_parameter_types": "rcl_interfaces/srv/GetParameterTypes",
    "list_parameters": "rcl_interfaces/srv/ListParameters",
    "set_parameters": "rcl_interfaces/srv/SetParameters",
    "set_parameters_atomically": "rcl_interfaces/srv/SetParametersAtomically",
    "get_type_description": "type_description_interfaces/srv/GetTypeDescription",
}
_OF_LIFECYCLE: Final = {
    "transition_event": "lifecycle_msgs/msg/TransitionEvent",
    "change_state": "lifecycle_msgs/srv/ChangeState",
    "get_state": "lifecycle_msgs/srv/GetState",
    "get_available_states": "lifecycle_msgs/srv/GetAvailableStates",
    "get_available_transitions": "lifecycle_msgs/srv/GetAvailableTransitions",
    "get_transition_graph": "lifecycle_msgs/srv/GetAvailableTransitions",
}
_INSTEAD: Final = (
    "remove it, or include `nodl://nodl_common_interfaces/node` instead: each node has it anyway"
)


@dataclass(frozen=True, slots=True)
class Barrier:
    """A document's statement that its code exists.

    `base` is the class to derive from; a mixin has none, others without one do not name it rightly.
    """

    base: BaseClass | None
    span: Span
    is_mixin: bool = False


def read(codegen: MapNode | None, problems: FileProblems) -> Barrier | None:
    """The barrier that `codegen` says; warns of what the generators of the ROS project would refuse."""
    if codegen is None:
        return None
    for tool in ("python", "cpp"):
        _check(tool, codegen.get(tool), problems)
    python, cpp = codegen.get("python"), codegen.get("cpp")
    if isinstance(python, MapNode):
        module, name = _text(python, "module"), _text(python, "class")
        method = _text(python, "publisher_method") or "create_publisher"
        is_base = _text(python, "role") == "BASE_CLASS" and module and name
        base = BaseClass(module or "", name or "", method) if is_base else None
        return Barrier(base, python.span, is_mixin=_text(python, "role") == "NO_GENERATE")
    if isinstance(cpp, MapNode) and _text(cpp, "role") == "BASE_CLASS":
        base = _OF_CPP.get(_text(cpp, "class") or "")
        return Barrier(base, cpp.span) if base else None
    return None


def other_tools(codegen: MapNode | None) -> tuple[tuple[str, str], ...]:
    """The maps that `codegen` has for tools other than ifgen, each as JSON, which is YAML too."""
    entries = codegen.entries if codegen else ()
    return tuple((key.name, _json(value)) for key, value in entries if key.name != "ifgen")


def of_framework(endpoint: Endpoint, *, is_lifecycle: bool) -> bool:
    """Whether rclpy makes such an endpoint in every node, or in every lifecycle node."""
    name = endpoint.name.rpartition("/")[2]
    if endpoint.category is Category.PUBLISHER and _TOPICS_OF_NODES.get(name) == endpoint.type_name:
        return True
    if endpoint.category not in {Category.PUBLISHER, Category.SERVICE_SERVER}:
        return False
    if not endpoint.name.startswith("~/") or "/" in endpoint.name[2:]:
        return False
    is_of_nodes = endpoint.category is Category.SERVICE_SERVER
    known = {**(_SERVICES_OF_NODES if is_of_nodes else {}), **(_OF_LIFECYCLE if is_lifecycle else {})}
    return known.get(name) == endpoint.type_name


def without_framework(own: Interface, *, is_lifecycle: bool) -> tuple[Interface, Interface]:
    """The share to generate, and the one that rclpy makes itself although nothing includes it."""
    reserved = Interface(
        tuple(p for p in own.parameters if names.reserved_parameter(p.name)),
        tuple(e for e in own.endpoints if of_framework(e, is_lifecycle=is_lifecycle)),
    )
    return own.without(reserved), reserved


def reserved_parameter(parameter: Parameter) -> Diagnostic:
    """Say that rclpy declares a parameter itself."""
    assert parameter.span is not None
    return Diagnostic(
        "reserved-parameter",
        f"rclpy declares the parameter `{shorten(parameter.name)}` itself: nothing is generated for it",
        Label(parameter.span),
        help=_INSTEAD,
        severity="warning",
    )


def reserved_endpoint(endpoint: Endpoint) -> Diagnostic:
    """Say that rclpy makes an endpoint itself."""
    assert endpoint.span is not None
    return Diagnostic(
        "reserved-endpoint",
        f"rclpy makes the {endpoint.category.singular} `{endpoint.name}` itself: nothing is generated for it",
        Label(endpoint.span),
        help=_INSTEAD,
        severity="warning",
    )


def two_bases(second: Barrier, first: Barrier) -> Diagnostic:
    """Say that a node cannot derive from two classes."""
    return Diagnostic(
        "two-bases",
        f"the node would derive from two classes, {_shown(first)} and {_shown(second)}",
        Label(second.span, "a base class"),
        (Label(first.span, "another one"),),
        "include only one of them, or one that includes the other",
    )


def no_base(barrier: Barrier) -> Diagnostic:
    """Say that the class of an included document is not clear."""
    return Diagnostic(
        "invalid-codegen",
        "this document stands for a class in Python, but does not name it",
        Label(barrier.span),
        help="write `{role: BASE_CLASS, module: my_pkg.my_module, class: MyNode}`, or `{role: NO_GENERATE}`",
    )


def _shown(barrier: Barrier) -> str:
    return f"{barrier.base.module}.{barrier.base.name}" if barrier.base else "one without a name"


def _check(tool: str, node: Node | None, problems: FileProblems) -> None:
    if not isinstance(node, MapNode):
        return
    for key, value in node.entries:
        if key.name not in _KEYS[tool]:
            problems.warning(_unknown_key, key, tool)
        elif not _fits(tool, key.name, value):
            problems.warning(_invalid, tool, key, value)
    role = _text(node, "role")
    needed = {"python": ("module", "class"), "cpp": ("class", "header")}[tool] if role == "BASE_CLASS" else ()
    for name in ("role", *needed):
        if node.get(name) is None:
            problems.warning(_missing, tool, name, node.span)


def _fits(tool: str, key: str, node: Node) -> bool:
    text = node.value if isinstance(node, ScalarNode) else None
    if not isinstance(text, str):
        return False
    if key == "role":
        return text in _ROLES[tool]
    if key == "header":
        return bool(text.strip())
    if tool == "cpp":
        return _CPP.fullmatch(text) is not None
    return _DOTTED.fullmatch(text) is not None and (key == "module" or "." not in text)


def _unknown_key(key: Key, tool: str) -> Diagnostic:
    found = unknown_key(key, f"codegen.{tool}", sorted(_KEYS[tool]))
    return Diagnostic("invalid-codegen", found.message, found.primary, help=found.help, severity="warning")


def _invalid(tool: str, key: Key, node: Node) -> Diagnostic:
    expected = f"one of {', '.join(_ROLES[tool])}" if key.name == "role" else "a name of this language"
    message = f"`codegen.{tool}.{key.name}` must be {expected}"
    return Diagnostic("invalid-codegen", message, Label(node.span), severity="warning")


def _missing(tool: str, name: str, span: Span) -> Diagnostic:
    message = f"`codegen.{tool}` needs the key `{name}`"
    return Diagnostic("invalid-codegen", message, Label(span), severity="warning")


def _text(node: MapNode, key: str) -> str | None:
    value = node.get(key)
    return value.value if isinstance(value, ScalarNode) and isinstance(value.value, str) else None


def _json(node: Node) -> str:
    return json.dumps(plain_value(node), ensure_ascii=True, default=str)


def base_of(barriers: Iterable[Barrier]) -> tuple[BaseClass | None, tuple[Diagnostic, ...]]:
    """The class that a node derives from, None for rclpy's Node, and what is wrong with the choice."""
    bases = [barrier for barrier in barriers if barrier.base is not None]
    wrong = tuple(two_bases(other, bases[0]) for other in bases[1:])
    return (bases[0].base if bases else None), wrong
