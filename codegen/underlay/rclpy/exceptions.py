"""The exceptions of rclpy's Python layer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport

if TYPE_CHECKING:
    from rclpy.impl.rcl.handle import TimerCancelledError as TimerCancelledError  # noqa: PLC0414 - programs import it from here
    from rclpy.parameter import AllowableParameterValue, Parameter
else:
    __getattr__ = reexport(__name__)

InvalidHandle = _rclpy.InvalidHandle


class NotInitializedException(Exception):
    """rclpy was used before `rclpy.init()`."""

    def __init__(self, message: str | None = None) -> None:
        detail = f" msg:{message}" if message else ""
        super().__init__(f"rclpy.init() has not been called.{detail}")


class NoTypeSupportImportedException(Exception):
    """A message class has no type support."""

    def __init__(self) -> None:
        super().__init__("no type_support imported")


class NameValidationException(Exception):
    """A name is not valid; the text points at the place."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        pointer = " " * (3 + invalid_index) + "^"
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n{pointer}")


class InvalidNamespaceException(NameValidationException):
    """A namespace is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """A node name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """A service name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class ParameterException(Exception):
    """Something is wrong with one or several parameters."""

    def __init__(self, error_msg: str, parameters: str | list[str]) -> None:
        super().__init__(f"{error_msg}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """A parameter was used that is not declared."""

    def __init__(self, parameters: str | list[str]) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared again."""

    def __init__(self, parameters: str | list[str]) -> None:
        super().__init__("Parameter(s) already declared", parameters)


class InvalidParameterException(ParameterException):
    """A parameter's name is not valid."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Invalid parameter name", parameter_name)


class InvalidParameterTypeException(ParameterException):
    """A value has another type than its parameter."""

    def __init__(self, desired_parameter: Parameter, expected_type: Parameter.Type) -> None:
        # Imported here: rclpy.parameter brings message classes along.
        from rclpy.parameter import Parameter

        name, value = desired_parameter._name, desired_parameter._value
        given = Parameter.Type.from_parameter_value(value).name
        super().__init__(
            f"Trying to set parameter '{name}' to '{value}' of type '{given}', "
            f"expecting type '{expected_type}'",
            name,
        )


class InvalidParameterValueException(ParameterException):
    """A value was refused by a callback or by the parameter's descriptor."""

    def __init__(self, parameter: str, value: AllowableParameterValue, reason: str) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterImmutableException(ParameterException):
    """A read-only parameter was to be changed."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)


class ParameterUninitializedException(ParameterException):
    """A parameter was read that is declared without a value."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(f"The parameter '{parameter_name}' is not initialized", parameter_name)


class ROSInterruptException(Exception):
    """Waiting ended because rclpy was shut down."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")
