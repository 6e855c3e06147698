"""Loggers and their levels."""

from __future__ import annotations

from pathlib import Path

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.logging_severity import LoggingSeverity as LoggingSeverity  # noqa: PLC0414 - users import it from here
from rclpy.impl.rcutils_logger import RcutilsLogger

_root_logger = RcutilsLogger()


def get_logger(name: str) -> RcutilsLogger:
    """Return a logger; dots in the name make it a child.

    :raises ValueError: for an empty name.
    """
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def initialize() -> None:
    """Set logging up; contexts do that too."""
    _rclpy.rclpy_logging_initialize()


def shutdown() -> None:
    """Forget all levels."""
    _rclpy.rclpy_logging_shutdown()


def clear_config() -> None:
    """Forget all levels and set logging up again."""
    shutdown()
    initialize()


def set_logger_level(name: str, level: int | LoggingSeverity, detailed_error: bool = False) -> None:
    """Set the level of a logger.

    :raises ValueError: if there is no such level.
    """
    _rclpy.rclpy_logging_set_logger_level(name, LoggingSeverity(level), detailed_error)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return a logger's level, or the one that it inherits."""
    return LoggingSeverity(_rclpy.rclpy_logging_get_logger_effective_level(name))


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level that a logger was given; UNSET if none."""
    return LoggingSeverity(_rclpy.rclpy_logging_get_logger_level(name))


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the level of this name, in any case; RuntimeError if there is none."""
    return LoggingSeverity(_rclpy.rclpy_logging_severity_level_from_string(log_severity))


def get_logging_directory() -> Path:
    """Return where log files belong."""
    return Path(_rclpy.rclpy_logging_get_logging_directory())
