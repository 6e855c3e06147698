"""Declaring, changing and listing the parameters of a node."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from types import TracebackType
from typing import Any, NamedTuple

from ifgen_runtime import serialize
from rcl_interfaces.msg import (
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    ParameterValue,
)

from rclpy.impl.messages import cleaned
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

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


def check_strings(names: list[Any]) -> None:
    """Raise TypeError unless all names are strings."""
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")


def list_names(names: list[str], prefixes: Any, depth: Any) -> ListParametersResult:
    """Return the names below the prefixes, at most `depth` levels deep (0: all), and their prefixes.

    Raises TypeError and ValueError for prefixes that are no list of strings, or a depth that makes no sense.
    """
    if not isinstance(prefixes, list):
        raise TypeError("The prefixes argument must be a list")
    if not all(isinstance(prefix, str) for prefix in prefixes):
        raise TypeError("All prefixes must be instances of type str")
    if not isinstance(depth, int):
        raise TypeError("The depth must be instance of type int")
    if depth < 0:
        raise ValueError("The depth must be greater than or equal to zero")
    listed = [name for name in names if _is_listed(name, prefixes, depth)]
    parents = [name.rpartition(PARAMETER_SEPARATOR_STRING)[0] for name in listed]
    return ListParametersResult(
        names=listed, prefixes=list(dict.fromkeys(parent for parent in parents if parent))
    )


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    """Whether a name is one of the prefixes or lies below one, and not too deep below.

    Depth 0 is no limit.
    """

    def is_shallow(rest: str) -> bool:
        return depth == 0 or rest.count(PARAMETER_SEPARATOR_STRING) < depth

    if not prefixes:
        return is_shallow(name)
    return any(
        name == prefix
        or (name.startswith(prefix + PARAMETER_SEPARATOR_STRING) and is_shallow(name[len(prefix) + 1 :]))
        for prefix in prefixes
    )
