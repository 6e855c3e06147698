"""Services with which others read and set logger levels."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

import rclpy
from rclpy.impl.reexports import reexport
from rclpy.qos import qos_profile_services_default
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

if TYPE_CHECKING:
    import rclpy.logging  # there is one by the time that anybody calls: nodes have loggers
    from rclpy.node import _BaseNode as BaseNode

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)


class LoggingService:
    """The services `get_logger_levels` and `set_logger_levels` of a node, for loggers of any name."""

    def __init__(self, node: BaseNode) -> None:
        services: tuple[tuple[Any, str, Callable[[Any, Any], Any]], ...] = (
            (GetLoggerLevels, "get_logger_levels", self._get_logger_levels),
            (SetLoggerLevels, "set_logger_levels", self._set_logger_levels),
        )
        for service_type, name, callback in services:
            node.create_service(
                service_type,
                TOPIC_SEPARATOR_STRING.join((node.get_name(), name)),
                callback,
                qos_profile=qos_profile_services_default,
            )

    def _get_logger_levels(self, request: Any, response: Any) -> Any:
        for name in request.names:
            response.levels.append(LoggerLevel(name=name, level=int(rclpy.logging.get_logger_level(name))))
        return response

    def _set_logger_levels(self, request: Any, response: Any) -> Any:
        for wanted in request.levels:
            result = SetLoggerLevelsResult()
            try:
                rclpy.logging.set_logger_level(wanted.name, wanted.level, detailed_error=True)
                result.successful = True
            except ValueError:
                result.reason = "Failed reason: Invalid logger level."
            except RuntimeError as error:
                result.reason = str(error)
            response.results.append(result)
        return response
