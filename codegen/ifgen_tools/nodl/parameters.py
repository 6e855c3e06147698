"""The parameters of a running node, as NoDL describes parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.param.client import json_value, remote_parameters

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor, ParameterValue

    from ifgen_tools.session import Session

_PATIENCE: Final = 5.0
"""Seconds in which a node has to answer each question."""

TYPES: Final[Mapping[int, str]] = {
    1: "bool",
    2: "int",
    3: "double",
    4: "string",
    5: "byte_array",
    6: "bool_array",
    7: "int_array",
    8: "double_array",
    9: "string_array",
}
"""The types of rcl_interfaces/msg/ParameterType as NoDL spells them; one that is not set has none."""


@dataclass(frozen=True, slots=True)
class RunningParameter:
    """A parameter with its value, None if it has none, and what its descriptor says; `step` 0 is any step."""

    name: str
    type: str
    value: Any
    description: str
    read_only: bool
    additional_constraints: str
    bounds: tuple[float, float] | None
    step: float


def parameters_of(session: Session, node: str) -> tuple[RunningParameter, ...] | None:
    """The parameters of a node; None if it has no parameter services or they do not answer."""
    found = described_parameters(session, node)
    return None if found is None else tuple(running_parameter(*pair) for pair in found)


def described_parameters(
    session: Session, node: str
) -> list[tuple[ParameterDescriptor, ParameterValue | None]] | None:
    """The descriptors and values of a node's parameters; None if its parameter services do not answer."""
    try:
        with remote_parameters(session, node, _PATIENCE) as remote:
            return remote.all()
    except ToolError:
        return None


def running_parameter(descriptor: ParameterDescriptor, value: ParameterValue | None) -> RunningParameter:
    """A parameter from its descriptor and its value, None for one without a value."""
    type_ = TYPES.get(value.type) if value else None
    limits: list[Any] = [*descriptor.floating_point_range, *descriptor.integer_range]
    return RunningParameter(
        name=descriptor.name,
        type=type_ or TYPES.get(descriptor.type, "none"),
        value=json_value(value) if value else None,
        description=descriptor.description,
        read_only=descriptor.read_only,
        additional_constraints=descriptor.additional_constraints,
        bounds=(limits[0].from_value, limits[0].to_value) if limits else None,
        step=limits[0].step if limits else 0,
    )
