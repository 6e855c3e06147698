"""The arguments of `declare_parameters`, checked and in one form."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from rcl_interfaces.msg import ParameterDescriptor, ParameterType, ParameterValue

from rclpy.parameter import Parameter

_NAME_ONLY = (
    "when declaring parameter named '{}', declaring a parameter only providing its name is deprecated. "
    "You have to either:\n"
    '\t- Pass a name and a default value different to "PARAMETER NOT SET" (and optionally a descriptor).\n'
    "\t- Pass a name and a parameter type.\n"
    "\t- Pass a name and a descriptor with `dynamic_typing=True"
)


class Declaration(NamedTuple):
    """A parameter to be declared with its first value."""

    parameter: Parameter
    descriptor: ParameterDescriptor


def read_declaration(
    index: int,
    entry: Any,
    namespace: str,
    overrides: Mapping[str, Parameter],
    validate_name: Callable[[str], object],
) -> Declaration:
    """Turn `(name[, type or value[, descriptor]])`, number `index` of a list, into a declaration.

    An override takes the place of the value. Raises TypeError or ValueError for entries that make no sense,
    and what `validate_name` raises for a bad name.
    """
    if not 1 <= len(entry) <= 3:
        raise TypeError(
            f"Invalid parameter tuple length at index {index} in parameters list: "
            f"{entry}; expecting length between 1 and 3"
        )
    name = entry[0]
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
    if namespace:
        name = f"{namespace}.{name}"
    validate_name(name)
    descriptor = entry[2] if len(entry) == 3 else ParameterDescriptor()
    if not isinstance(descriptor, ParameterDescriptor):
        raise TypeError(
            f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor."
        )
    if len(entry) == 1:
        warnings.warn(_NAME_ONLY.format(name), stacklevel=4)
        descriptor.dynamic_typing = True
    value = _settle_type(name, entry[1] if len(entry) > 1 else None, descriptor)
    if name in overrides:
        value = overrides[name].value
    return Declaration(Parameter(name, value=value), descriptor)


def _settle_type(name: str, type_or_value: Any, descriptor: ParameterDescriptor) -> Any:
    """Write the type into the descriptor and return the value, None when only a type was given."""
    if isinstance(type_or_value, Parameter.Type):
        if type_or_value is Parameter.Type.NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if descriptor.dynamic_typing is True:
            raise ValueError(
                f"When declaring parameter {{{name}}} passing a descriptor with"
                "`dynamic_typing=True` is not allowed when the parameter type is provided"
            )
        descriptor.type = type_or_value.value
        return None
    if not descriptor.dynamic_typing:
        if isinstance(type_or_value, ParameterValue):
            descriptor.type = type_or_value.type
        else:
            descriptor.type = Parameter.Type.from_parameter_value(type_or_value).value
        if descriptor.type == ParameterType.PARAMETER_NOT_SET:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
    return type_or_value
