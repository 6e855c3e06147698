"""Messages of rcl_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from rcl_interfaces.msg._floating_point_range import FloatingPointRange as FloatingPointRange
    from rcl_interfaces.msg._integer_range import IntegerRange as IntegerRange
    from rcl_interfaces.msg._list_parameters_result import ListParametersResult as ListParametersResult
    from rcl_interfaces.msg._log import Log as Log
    from rcl_interfaces.msg._logger_level import LoggerLevel as LoggerLevel
    from rcl_interfaces.msg._parameter import Parameter as Parameter
    from rcl_interfaces.msg._parameter_descriptor import ParameterDescriptor as ParameterDescriptor
    from rcl_interfaces.msg._parameter_event import ParameterEvent as ParameterEvent
    from rcl_interfaces.msg._parameter_event_descriptors import (
        ParameterEventDescriptors as ParameterEventDescriptors,
    )
    from rcl_interfaces.msg._parameter_type import ParameterType as ParameterType
    from rcl_interfaces.msg._parameter_value import ParameterValue as ParameterValue
    from rcl_interfaces.msg._set_logger_levels_result import SetLoggerLevelsResult as SetLoggerLevelsResult
    from rcl_interfaces.msg._set_parameters_result import SetParametersResult as SetParametersResult

__all__ = [
    "FloatingPointRange",
    "IntegerRange",
    "ListParametersResult",
    "Log",
    "LoggerLevel",
    "Parameter",
    "ParameterDescriptor",
    "ParameterEvent",
    "ParameterEventDescriptors",
    "ParameterType",
    "ParameterValue",
    "SetLoggerLevelsResult",
    "SetParametersResult",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "FloatingPointRange": "_floating_point_range",
        "IntegerRange": "_integer_range",
        "ListParametersResult": "_list_parameters_result",
        "Log": "_log",
        "LoggerLevel": "_logger_level",
        "Parameter": "_parameter",
        "ParameterDescriptor": "_parameter_descriptor",
        "ParameterEvent": "_parameter_event",
        "ParameterEventDescriptors": "_parameter_event_descriptors",
        "ParameterType": "_parameter_type",
        "ParameterValue": "_parameter_value",
        "SetLoggerLevelsResult": "_set_logger_levels_result",
        "SetParametersResult": "_set_parameters_result",
    },
)
