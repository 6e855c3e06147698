"""The effects of an accepted change on the parameters of a node."""

from __future__ import annotations

from collections.abc import Iterable
from types import TracebackType
from typing import Any

from ifgen_runtime import serialize
from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent

from rclpy.impl.messages import cleaned
from rclpy.parameter import Parameter


def must_fit(message: Any) -> None:
    """Refuse a parameter or a descriptor that no message can hold, such as an integer of 70 bits.

    :raises SerializationError: with the field.
    """
    serialize(cleaned(message))


class Restoring:
    """A context in which parameters of a node change: all of them, or none if it fails or it `is_needed`."""

    def __init__(
        self,
        changing: Iterable[Parameter],
        parameters: dict[str, Parameter],
        descriptors: dict[str, ParameterDescriptor],
    ) -> None:
        self.is_needed = True
        self._parameters, self._descriptors = parameters, descriptors
        names = [parameter.name for parameter in changing]
        self._before = [(name, parameters.get(name), descriptors.get(name)) for name in names]
        self._types = [0 if known is None else known.type for _, _, known in self._before]

    def __enter__(self) -> Restoring:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self.is_needed:
            return
        for (name, parameter, descriptor), type_ in zip(self._before, self._types, strict=True):
            if parameter is None:
                self._parameters.pop(name, None)
            else:
                self._parameters[name] = parameter
            if descriptor is None:
                self._descriptors.pop(name, None)
            else:
                self._descriptors[name] = descriptor
                descriptor.type = type_  # which a dynamic one takes from the value


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
