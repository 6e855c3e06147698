"""Parameters: a name, a type, a value, and their message form."""

from __future__ import annotations

import array
from collections.abc import Callable, Iterator
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterType, ParameterValue

from rclpy.impl import distro
from rclpy.impl.typed import Generic, T

PARAMETER_SEPARATOR_STRING = "."

if TYPE_CHECKING:
    Sequenced = (
        list[bytes] | list[bool] | list[int] | list[float] | list[str] | tuple[Any, ...] | array.array[Any]
    )
    AllowableParameterValue = bool | int | float | str | Sequenced | None


def _is_byte(value: object) -> bool:
    return isinstance(value, bytes) and len(value) == 1


def _is_a(kind: type) -> Callable[[object], bool]:
    return lambda value: isinstance(value, kind)


if TYPE_CHECKING:
    _TypeBase = Enum
else:
    _TypeBase = IntEnum if distro.follows("parameter_type") else Enum


class Parameter(Generic[T]):
    """A named, typed value. Two parameters are equal only if they are the same object."""

    class Type(_TypeBase):
        """The types a parameter can have, numbered as in rcl_interfaces/msg/ParameterType."""

        NOT_SET = ParameterType.PARAMETER_NOT_SET
        BOOL = ParameterType.PARAMETER_BOOL
        INTEGER = ParameterType.PARAMETER_INTEGER
        DOUBLE = ParameterType.PARAMETER_DOUBLE
        STRING = ParameterType.PARAMETER_STRING
        BYTE_ARRAY = ParameterType.PARAMETER_BYTE_ARRAY
        BOOL_ARRAY = ParameterType.PARAMETER_BOOL_ARRAY
        INTEGER_ARRAY = ParameterType.PARAMETER_INTEGER_ARRAY
        DOUBLE_ARRAY = ParameterType.PARAMETER_DOUBLE_ARRAY
        STRING_ARRAY = ParameterType.PARAMETER_STRING_ARRAY

        @classmethod
        def from_parameter_value(cls, parameter_value: AllowableParameterValue) -> Parameter.Type:
            """Return the type that a Python value asks for; raises TypeError when no type fits.

            An empty list is a byte array, and True is no integer.
            """
            if parameter_value is None:
                return cls.NOT_SET
            for kind, scalar in _SCALARS:
                if isinstance(parameter_value, kind):
                    return scalar
            if not isinstance(parameter_value, (list, tuple, array.array)):
                raise TypeError(f"The given value is not one of the allowed types '{parameter_value}'.")
            for kind, sequence in _SEQUENCES:
                if all(isinstance(element, kind) for element in parameter_value):
                    return sequence
            raise TypeError(f"The given value is not a list of one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Whether a Python value can be stored in a parameter of this type."""
            if self is Parameter.Type.NOT_SET:
                return parameter_value is None
            containers, accepts = _CHECKS[self]
            if not containers:
                return accepts(parameter_value)
            elements: Any = parameter_value
            return isinstance(parameter_value, containers) and all(map(accepts, elements))

    @classmethod
    def from_parameter_msg(cls, param_msg: ParameterMsg) -> Parameter:
        """Return the parameter that an rcl_interfaces/msg/Parameter describes."""
        type_ = Parameter.Type(value=param_msg.value.type)
        field = _FIELDS.get(type_)
        return cls(param_msg.name, type_, None if field is None else getattr(param_msg.value, field))

    def __init__(self, name: str, type_: Parameter.Type | None = None, value: Any = None) -> None:
        """Without a type the value decides.

        Raises TypeError for values that no type fits, ValueError for a mismatch.
        """
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._type_ = type_
        self._name = name
        self._value = value

    @property
    def name(self) -> str:
        """The full name, namespaces joined by dots."""
        return self._name

    @property
    def type_(self) -> Parameter.Type:
        """The type."""
        return self._type_

    @property
    def value(self) -> Any:
        """The value as a Python object; None when not set."""
        return self._value

    def get_parameter_value(self) -> ParameterValue:
        """Return the value as a message."""
        message = ParameterValue(type=self.type_.value)
        if field := _FIELDS.get(self.type_):
            setattr(message, field, self.value)
        return message

    def to_parameter_msg(self) -> ParameterMsg:
        """Return name and value as a message."""
        return ParameterMsg(name=self.name, value=self.get_parameter_value())


_Type = Parameter.Type
# In the order in which a value is tried: True is an int for Python, but not for ROS.
_SCALARS: tuple[tuple[type, Parameter.Type], ...] = (
    (bool, _Type.BOOL),
    (int, _Type.INTEGER),
    (float, _Type.DOUBLE),
    (str, _Type.STRING),
)
_SEQUENCES: tuple[tuple[type, Parameter.Type], ...] = (
    (bytes, _Type.BYTE_ARRAY),
    (bool, _Type.BOOL_ARRAY),
    (int, _Type.INTEGER_ARRAY),
    (float, _Type.DOUBLE_ARRAY),
    (str, _Type.STRING_ARRAY),
)
_FIELDS: dict[Parameter.Type, str] = {
    type_: f"{type_.name.lower()}_value" for type_ in _Type if type_ is not _Type.NOT_SET
}
_LISTS: tuple[type, ...] = (list, tuple)
_NUMBERS: tuple[type, ...] = (list, tuple, array.array)
_CHECKS: dict[Parameter.Type, tuple[tuple[type, ...], Callable[[Any], bool]]] = {
    _Type.BOOL: ((), _is_a(bool)),
    _Type.INTEGER: ((), _is_a(int)),
    _Type.DOUBLE: ((), _is_a(float)),
    _Type.STRING: ((), _is_a(str)),
    _Type.BYTE_ARRAY: (_LISTS, _is_byte),
    _Type.BOOL_ARRAY: (_LISTS, _is_a(bool)),
    _Type.INTEGER_ARRAY: (_NUMBERS, _is_a(int)),
    _Type.DOUBLE_ARRAY: (_NUMBERS, _is_a(float)),
    _Type.STRING_ARRAY: (_LISTS, _is_a(str)),
}


def get_parameter_value(string_value: str) -> ParameterValue:
    """Read a value as YAML and return its message; what fits no parameter type stays a string."""
    import yaml  # its import costs more than the rest of this module

    try:
        value = yaml.safe_load(string_value)
    except yaml.parser.ParserError:
        value = string_value
    if value is None:
        value = string_value
    type_ = _type_of_yaml(value)
    if type_ is _Type.STRING and isinstance(value, list):
        value = string_value
    message = ParameterValue(type=type_.value)
    setattr(message, _FIELDS[type_], value)
    return message


def _type_of_yaml(value: Any) -> Parameter.Type:
    for kind, scalar in _SCALARS[:3]:
        if isinstance(value, kind):
            return scalar
    if isinstance(value, list):
        for kind, sequence in _SEQUENCES[1:]:
            if all(isinstance(element, kind) for element in value):
                return sequence
    return _Type.STRING


def parameter_value_to_python(parameter_value: ParameterValue) -> Any:
    """Return the Python value of a message, sequences as lists; raises RuntimeError for unknown types."""
    try:
        type_ = _Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if type_ is _Type.NOT_SET:
        return None
    value = getattr(parameter_value, _FIELDS[type_])
    return list(value) if _CHECKS[type_][0] else value


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: list[str] | None = None,
    namespace: str = "",
) -> dict[str, ParameterMsg]:
    """Return the parameters of a YAML file as messages by name.

    Takes the parameters of the given nodes, by default those of every node except `/**`, and those of `/**`
    first if `use_wildcard`. For a node, sections of wildcards (`/*/node`, `/**/node`) come before those of
    its name. Sections may stand inside their namespace. `namespace` is put before every name. Raises
    RuntimeError if the file lacks the requested parameters.
    """
    import yaml  # its import costs more than the rest of this module

    with open(parameter_file) as file:  # noqa: PTH123 - also takes file descriptors, as upstream's does
        content = yaml.safe_load(file)
    values: dict[str, Any] = {}
    for name, section in _sections(content, use_wildcard, target_nodes):
        if not isinstance(section, dict) or "ros__parameters" not in section:
            raise RuntimeError(f"YAML file is not a valid ROS parameter file for node {name}")
        values.update(section["ros__parameters"])
    return _unpack_parameter_dict(namespace, values)


def _sections(
    content: dict[str, Any], use_wildcard: bool, target_nodes: list[str] | None
) -> list[tuple[str, Any]]:
    """The sections of the file that count, with their names; the later ones win."""
    selected = [("/**", content["/**"])] if use_wildcard and "/**" in content else []
    if target_nodes:
        for target in target_nodes:
            found = list(_sections_of(content, target if target.startswith("/") else f"/{target}"))
            if not found and target in content:
                found = [(target, content[target])]
            if not found:
                raise RuntimeError(
                    f"Param file does not contain parameters for {target},only for nodes: {list(content)} "
                )
            selected += found
    else:
        selected += [each for key in content if key != "/**" for each in _nested(key, content[key])]
    if not selected:
        raise RuntimeError("Param file does not contain selected parameters")
    return selected


def _sections_of(content: dict[str, Any], target: str) -> Iterator[tuple[str, Any]]:
    """The sections for one node, an absolute name: by wildcards first, then by its name."""
    namespace, _, node = target.rpartition("/")
    is_one_level = namespace.count("/") == 1
    wildcards = (("/**", True), ("/*", is_one_level))
    for wildcard, fits in wildcards:
        if fits and f"{wildcard}/{node}" in content:
            yield target, content[f"{wildcard}/{node}"]
        if fits and isinstance(content.get(wildcard), dict) and node in content[wildcard]:
            yield target, content[wildcard][node]
    if target in content:
        yield target, content[target]
    if not namespace and node in content:
        yield target, content[node]
    for key in (namespace, namespace[1:]):
        section = content.get(key) if key else None
        if isinstance(section, dict) and node in section:
            yield target, section[node]


def _nested(name: str, section: Any) -> Iterator[tuple[str, Any]]:
    """A node's section, or those inside a namespace."""
    is_namespace = isinstance(section, dict) and "ros__parameters" not in section
    inner = [key for key, value in section.items() if isinstance(value, dict)] if is_namespace else []
    if not inner:
        yield name, section
    for key in inner:
        yield from _nested(f"{name}/{key}", section[key])


def _unpack_parameter_dict(namespace: str, parameter_dict: dict[str, Any]) -> dict[str, ParameterMsg]:
    """Flatten nested maps into dotted names."""
    parameters: dict[str, ParameterMsg] = {}
    for key, value in parameter_dict.items():
        name = namespace + key
        if isinstance(value, dict):
            parameters.update(_unpack_parameter_dict(name + PARAMETER_SEPARATOR_STRING, value))
        else:
            parameters[name] = ParameterMsg(name=name, value=get_parameter_value(str(value)))
    return parameters
