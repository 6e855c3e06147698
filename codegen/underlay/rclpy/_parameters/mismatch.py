"""The parameter `on_type_mismatch`: what a node does if another one has another definition of a type.

It need not be declared: an override counts. A declared one counts for what its value is, from its declaration
on. Endpoints that have met stay as they are.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from rclpy.parameter import Parameter

if TYPE_CHECKING:
    from rclpy.node import Node

ON_TYPE_MISMATCH = "on_type_mismatch"
_VARIABLE = "IFGEN_ON_TYPE_MISMATCH"


def follow_policy(node: Node) -> None:
    """Let the node's place in the graph have the policy of today; ValueError for a value that is none."""
    node.handle.graph_node.on_type_mismatch = _policy(node)


def policy_fault(parameter: Parameter) -> str | None:
    """The reason why this parameter may not have its value; None for any other parameter."""
    if parameter.name != ON_TYPE_MISMATCH or parameter.type_ is Parameter.Type.NOT_SET:
        return None
    from ifgen_runtime.mismatch.policy import policy_of  # late: few nodes have the parameter

    try:
        policy_of(None, parameter.value)
    except ValueError as error:
        return str(error)
    return None


def _policy(node: Node) -> str:
    known = node._parameters.get(ON_TYPE_MISMATCH) or node._parameter_overrides.get(ON_TYPE_MISMATCH)
    if known is None and not hasattr(type(node), ON_TYPE_MISMATCH) and not os.environ.get(_VARIABLE):
        return "warn"
    from ifgen_runtime.mismatch.policy import policy_of  # late: most nodes warn

    return policy_of(node, None if known is None else known.value).value
