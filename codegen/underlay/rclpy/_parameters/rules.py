"""Whether values obey the descriptors of their parameters, and the policy in `on_type_mismatch`."""

from __future__ import annotations

import math
import os
from collections.abc import Container, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult

from rclpy.parameter import Parameter

if TYPE_CHECKING:
    from rclpy.node import _BaseNode as BaseNode


# What a node does if another one has another definition of a type. It need not be declared: an override
# counts. A declared one counts for what its value is, from its declaration on. Endpoints that have met stay.
ON_TYPE_MISMATCH = "on_type_mismatch"
_VARIABLE = "IFGEN_ON_TYPE_MISMATCH"


def follow_policy(node: BaseNode) -> None:
    """Let the node's place in the graph have the policy of today; ValueError for a value that is none."""
    node.handle.graph_node.on_type_mismatch = _policy(node)


def policy_fault(parameter: Parameter) -> str | None:
    """The reason why this parameter may not have its value; None for any other parameter."""
    if parameter.name != ON_TYPE_MISMATCH or parameter.type_ is Parameter.Type.NOT_SET:
        return None
    try:
        _policy_of(None, parameter.value)
    except ValueError as error:
        return str(error)
    return None


def _policy(node: BaseNode) -> str:
    known = node._parameters.get(ON_TYPE_MISMATCH) or node._parameter_overrides.get(ON_TYPE_MISMATCH)
    if known is None and not hasattr(type(node), ON_TYPE_MISMATCH) and not os.environ.get(_VARIABLE):
        return "warn"
    return _policy_of(node, None if known is None else known.value)


def _policy_of(node: BaseNode | None, value: object) -> str:
    from ifgen_runtime.mismatch.policy import policy_of  # late: most nodes warn

    return policy_of(node, value).value


RELATIVE_TOLERANCE = 1e-6


def accepted() -> SetParametersResult:
    """Return the result of a value that may be set."""
    return SetParametersResult(successful=True)


def refused(reason: str) -> SetParametersResult:
    """Return the result of a value that may not be set."""
    return SetParametersResult(successful=False, reason=reason)


def check(
    parameters: Iterable[Parameter],
    descriptors: Mapping[str, ParameterDescriptor],
    declared: Container[str],
    *,
    check_read_only: bool,
    tolerance: float,
) -> SetParametersResult:
    """Hold values against their descriptors, where they have one; the first fault refuses them all.

    A descriptor takes over the parameter's name, and its type if dynamic.
    """
    for parameter in parameters:
        descriptor = descriptors.get(parameter.name)
        if descriptor is None:
            continue
        descriptor.name = parameter.name
        if check_read_only and descriptor.read_only:
            return refused(f"Trying to set a read-only parameter: {parameter.name}.")
        fault = None
        if descriptor.dynamic_typing:
            descriptor.type = parameter.type_.value
        else:
            fault = type_fault(parameter, descriptor, declared=parameter.name in declared)
        if fault := fault or _range_fault(parameter, descriptor, tolerance) or policy_fault(parameter):
            return refused(fault)
    return accepted()


def _range_fault(parameter: Parameter, descriptor: ParameterDescriptor, tolerance: float) -> str | None:
    """The reason why a number is not in the range of its descriptor."""
    if parameter.type_ is Parameter.Type.INTEGER and descriptor.integer_range:
        return integer_range_fault(parameter, descriptor.integer_range[0])
    if parameter.type_ is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return floating_point_range_fault(parameter, descriptor.floating_point_range[0], tolerance)
    return None


def type_fault(parameter: Parameter, descriptor: ParameterDescriptor, *, declared: bool) -> str | None:
    """The reason why the type is wrong for a statically typed parameter; None if it is right."""
    if parameter.type_ is Parameter.Type.NOT_SET:
        return "Static parameter cannot be undeclared" if declared else None
    if parameter.type_.value != descriptor.type:
        expected = Parameter.Type(descriptor.type)
        return f"Wrong parameter type, expected '{expected}' got '{parameter.type_}'"
    return None


def _bounds(range_: Any) -> tuple[Any, Any]:
    return min(range_.from_value, range_.to_value), max(range_.from_value, range_.to_value)


def integer_range_fault(parameter: Parameter, range_: IntegerRange) -> str | None:
    """The reason why an integer is outside its range or between its steps. Both ends are always allowed."""
    low, high = _bounds(range_)
    name, value = parameter.name, parameter.value
    if value in (low, high):
        return None
    if not low < value < high:
        return f"Parameter {name} out of range. Min: {low}, Max: {high}, value: {value}"
    if range_.step and (value - low) % range_.step:
        return (
            f"The parameter value for {name} is not a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {range_.step}"
        )
    return None


def floating_point_range_fault(
    parameter: Parameter, range_: FloatingPointRange, tolerance: float
) -> str | None:
    """The reason why a float is outside its range or far from its steps.

    `tolerance` is relative, both ends are allowed.
    """

    def is_close(other: float) -> bool:
        return math.isclose(value, other, rel_tol=tolerance)

    low, high = _bounds(range_)
    name, value = parameter.name, parameter.value
    if is_close(low) or is_close(high):
        return None
    if not low < value < high:
        return f"Parameter {name} out of range Min: {low}, Max: {high}, value: {value}"
    if range_.step and not is_close(low + round((value - low) / range_.step) * range_.step):
        return (
            f"The parameter value for {name} is not close enough to a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {range_.step}"
        )
    return None
