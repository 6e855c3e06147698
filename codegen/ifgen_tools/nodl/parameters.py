"""The parameters of a running node, as NoDL describes parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen_tools.errors import ToolError
from ifgen_tools.param.remote import RemoteParameters

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor, ParameterValue

    from ifgen_tools.session import Session

_PATIENCE: Final = 5.0
"""Seconds in which a node has to answer each question."""

_TYPES: Final[Mapping[int, str]] = {
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
    try:
        remote = RemoteParameters(session, node, _PATIENCE)
        names = remote.names()
        descriptors = remote.descriptors(names)
        values = remote.values(names)
    except ToolError:
        return None
    if len(descriptors) != len(names):
        return None
    return tuple(_parameter(each, values.get(each.name)) for each in descriptors)


def _parameter(descriptor: ParameterDescriptor, value: ParameterValue | None) -> RunningParameter:
    type_ = _TYPES.get(value.type) if value else None
    limits: list[Any] = [*descriptor.floating_point_range, *descriptor.integer_range]
    return RunningParameter(
        name=descriptor.name,
        type=type_ or _TYPES.get(descriptor.type, "none"),
        value=_plain(value) if value else None,
        description=descriptor.description,
        read_only=descriptor.read_only,
        additional_constraints=descriptor.additional_constraints,
        bounds=(limits[0].from_value, limits[0].to_value) if limits else None,
        step=limits[0].step if limits else 0,
    )


def _plain(value: ParameterValue) -> Any:
    """The value in plain Python; None if it is not set."""
    from rclpy.parameter import parameter_value_to_python  # found once the transport has been chosen

    found = parameter_value_to_python(value)
    if not _TYPES.get(value.type, "").endswith("_array"):
        return found
    return [each[0] if isinstance(each, bytes) else each for each in found]
