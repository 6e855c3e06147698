"""The effects of an accepted change on the parameters of a node."""

from __future__ import annotations

from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent

from rclpy.parameter import Parameter


def keep_or_remove(
    parameter: Parameter,
    parameters: dict[str, Parameter],
    descriptors: dict[str, ParameterDescriptor],
    declared_with: dict[str, ParameterDescriptor] | None,
    event: ParameterEvent,
    *,
    keep: bool,
) -> None:
    """Keep or replace one of a node's parameters, or remove it, and write that into the event.

    `declared_with` has its descriptor if it is being declared.
    """
    name = parameter.name
    if not keep:
        event.deleted_parameters.append(parameter.to_parameter_msg())
        parameters.pop(name, None)
        descriptors.pop(name, None)
        return
    if declared_with is not None:
        descriptors[name] = declared_with[name]
    elif name not in descriptors:
        descriptors[name] = ParameterDescriptor(dynamic_typing=True)
    known = parameters.get(name)
    is_new = known is None or known.type_ is Parameter.Type.NOT_SET
    (event.new_parameters if is_new else event.changed_parameters).append(parameter.to_parameter_msg())
    parameters[name] = parameter
