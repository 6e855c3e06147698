"""Services of rcl_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from rcl_interfaces.srv._describe_parameters import DescribeParameters as DescribeParameters
    from rcl_interfaces.srv._describe_parameters import DescribeParameters_Event as DescribeParameters_Event
    from rcl_interfaces.srv._describe_parameters import (
        DescribeParameters_Request as DescribeParameters_Request,
    )
    from rcl_interfaces.srv._describe_parameters import (
        DescribeParameters_Response as DescribeParameters_Response,
    )
    from rcl_interfaces.srv._get_logger_levels import GetLoggerLevels as GetLoggerLevels
    from rcl_interfaces.srv._get_logger_levels import GetLoggerLevels_Event as GetLoggerLevels_Event
    from rcl_interfaces.srv._get_logger_levels import GetLoggerLevels_Request as GetLoggerLevels_Request
    from rcl_interfaces.srv._get_logger_levels import GetLoggerLevels_Response as GetLoggerLevels_Response
    from rcl_interfaces.srv._get_parameter_types import GetParameterTypes as GetParameterTypes
    from rcl_interfaces.srv._get_parameter_types import GetParameterTypes_Event as GetParameterTypes_Event
    from rcl_interfaces.srv._get_parameter_types import GetParameterTypes_Request as GetParameterTypes_Request
    from rcl_interfaces.srv._get_parameter_types import (
        GetParameterTypes_Response as GetParameterTypes_Response,
    )
    from rcl_interfaces.srv._get_parameters import GetParameters as GetParameters
    from rcl_interfaces.srv._get_parameters import GetParameters_Event as GetParameters_Event
    from rcl_interfaces.srv._get_parameters import GetParameters_Request as GetParameters_Request
    from rcl_interfaces.srv._get_parameters import GetParameters_Response as GetParameters_Response
    from rcl_interfaces.srv._list_parameters import ListParameters as ListParameters
    from rcl_interfaces.srv._list_parameters import ListParameters_Event as ListParameters_Event
    from rcl_interfaces.srv._list_parameters import ListParameters_Request as ListParameters_Request
    from rcl_interfaces.srv._list_parameters import ListParameters_Response as ListParameters_Response
    from rcl_interfaces.srv._set_logger_levels import SetLoggerLevels as SetLoggerLevels
    from rcl_interfaces.srv._set_logger_levels import SetLoggerLevels_Event as SetLoggerLevels_Event
    from rcl_interfaces.srv._set_logger_levels import SetLoggerLevels_Request as SetLoggerLevels_Request
    from rcl_interfaces.srv._set_logger_levels import SetLoggerLevels_Response as SetLoggerLevels_Response
    from rcl_interfaces.srv._set_parameters import SetParameters as SetParameters
    from rcl_interfaces.srv._set_parameters import SetParameters_Event as SetParameters_Event
    from rcl_interfaces.srv._set_parameters import SetParameters_Request as SetParameters_Request
    from rcl_interfaces.srv._set_parameters import SetParameters_Response as SetParameters_Response
    from rcl_interfaces.srv._set_parameters_atomically import (
        SetParametersAtomically as SetParametersAtomically,
    )
    from rcl_interfaces.srv._set_parameters_atomically import (
        SetParametersAtomically_Event as SetParametersAtomically_Event,
    )
    from rcl_interfaces.srv._set_parameters_atomically import (
        SetParametersAtomically_Request as SetParametersAtomically_Request,
    )
    from rcl_interfaces.srv._set_parameters_atomically import (
        SetParametersAtomically_Response as SetParametersAtomically_Response,
    )

__all__ = [
    "DescribeParameters",
    "DescribeParameters_Event",
    "DescribeParameters_Request",
    "DescribeParameters_Response",
    "GetLoggerLevels",
    "GetLoggerLevels_Event",
    "GetLoggerLevels_Request",
    "GetLoggerLevels_Response",
    "GetParameterTypes",
    "GetParameterTypes_Event",
    "GetParameterTypes_Request",
    "GetParameterTypes_Response",
    "GetParameters",
    "GetParameters_Event",
    "GetParameters_Request",
    "GetParameters_Response",
    "ListParameters",
    "ListParameters_Event",
    "ListParameters_Request",
    "ListParameters_Response",
    "SetLoggerLevels",
    "SetLoggerLevels_Event",
    "SetLoggerLevels_Request",
    "SetLoggerLevels_Response",
    "SetParameters",
    "SetParametersAtomically",
    "SetParametersAtomically_Event",
    "SetParametersAtomically_Request",
    "SetParametersAtomically_Response",
    "SetParameters_Event",
    "SetParameters_Request",
    "SetParameters_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "DescribeParameters": "_describe_parameters",
        "DescribeParameters_Event": "_describe_parameters",
        "DescribeParameters_Request": "_describe_parameters",
        "DescribeParameters_Response": "_describe_parameters",
        "GetLoggerLevels": "_get_logger_levels",
        "GetLoggerLevels_Event": "_get_logger_levels",
        "GetLoggerLevels_Request": "_get_logger_levels",
        "GetLoggerLevels_Response": "_get_logger_levels",
        "GetParameterTypes": "_get_parameter_types",
        "GetParameterTypes_Event": "_get_parameter_types",
        "GetParameterTypes_Request": "_get_parameter_types",
        "GetParameterTypes_Response": "_get_parameter_types",
        "GetParameters": "_get_parameters",
        "GetParameters_Event": "_get_parameters",
        "GetParameters_Request": "_get_parameters",
        "GetParameters_Response": "_get_parameters",
        "ListParameters": "_list_parameters",
        "ListParameters_Event": "_list_parameters",
        "ListParameters_Request": "_list_parameters",
        "ListParameters_Response": "_list_parameters",
        "SetLoggerLevels": "_set_logger_levels",
        "SetLoggerLevels_Event": "_set_logger_levels",
        "SetLoggerLevels_Request": "_set_logger_levels",
        "SetLoggerLevels_Response": "_set_logger_levels",
        "SetParameters": "_set_parameters",
        "SetParameters_Event": "_set_parameters",
        "SetParameters_Request": "_set_parameters",
        "SetParameters_Response": "_set_parameters",
        "SetParametersAtomically": "_set_parameters_atomically",
        "SetParametersAtomically_Event": "_set_parameters_atomically",
        "SetParametersAtomically_Request": "_set_parameters_atomically",
        "SetParametersAtomically_Response": "_set_parameters_atomically",
    },
)
