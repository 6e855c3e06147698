"""Loggers: levels, filters that belong to the calling line, children that share a node's /rosout."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import FrameType
from typing import Any, ClassVar, NamedTuple

from rclpy.clock import Clock
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.logging_severity import LoggingSeverity

__all__ = [
    "CallerId",
    "LoggingFilter",
    "Once",
    "RcutilsLogger",
    "SkipFirst",
    "Throttle",
    "get_filters_from_kwargs",
    "supported_filters",
]


Context = dict[str, Any]
"""The state of a call's filters, which belongs to the line that calls."""


class LoggingFilter:
    """Base of all filters."""

    params: ClassVar[dict[str, Any]] = {}  # keyword -> default; None: the caller must give it

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Put the parameters and the first state into a context."""
        for parameter, default in cls.params.items():
            value = kwargs.get(parameter, default)
            if value is None:
                raise TypeError(
                    f'Required parameter "{parameter}" was not specified for logging filter "{cls.__name__}"'
                )
            context[parameter] = value

    @staticmethod
    def should_log(context: Context) -> bool:
        """Decide, and note what the next decision needs."""
        return True


class Once(LoggingFilter):
    """Lets the first message through."""

    params: ClassVar[dict[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Note that nothing was logged yet."""
        super().initialize_context(context, **kwargs)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether this is the first message."""
        logged, context["has_been_logged_once"] = context["has_been_logged_once"], True
        return not logged


class Throttle(LoggingFilter):
    """Lets a message through when the last one is long enough ago, by the clock that is given."""

    params: ClassVar[dict[str, Any]] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock()}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Check the clock. Raises ValueError if it is not a Clock."""
        super().initialize_context(context, **kwargs)
        context["throttle_last_logged"] = 0
        source = context["throttle_time_source_type"]
        if not isinstance(source, Clock):
            raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether the last message is long enough ago."""
        now = context["throttle_time_source_type"].now().nanoseconds
        if now < context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9:
            return False
        context["throttle_last_logged"] = now
        return True


class SkipFirst(LoggingFilter):
    """Lets all but the first message through."""

    params: ClassVar[dict[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Note that nothing was skipped yet."""
        super().initialize_context(context, **kwargs)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether the first message was skipped."""
        skipped, context["first_has_been_skipped"] = context["first_has_been_skipped"], True
        return bool(skipped)


# In the order in which they decide; a program may add its own.
supported_filters: dict[str, type[LoggingFilter]] = {
    "throttle": Throttle,
    "skip_first": SkipFirst,
    "once": Once,
}


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the names of the filters that these keywords ask for.

    :raises TypeError: for a keyword that no filter has, or if a filter's keyword is missing.
    """
    known = [parameter for kind in supported_filters.values() for parameter in kind.params]
    asked_for = [
        name
        for name, kind in supported_filters.items()
        if any(kwargs.get(parameter) for parameter in kind.params)
    ]
    for name in asked_for:
        for parameter, default in supported_filters[name].params.items():
            if default is None and parameter not in kwargs:
                raise TypeError(
                    f'required parameter "{parameter}" not specified '
                    f'but is required for the the logging filter "{name}"'
                )
    for keyword in kwargs:
        if keyword not in known:
            raise TypeError(f'parameter "{keyword}" is not one of the recognized logging options "{known}"')
    return asked_for


# Parts of the paths of files whose frames are not the caller; wrappers around loggers add their own.
_internal_callers: list[str] = [
    os.path.realpath(__file__),
    str(Path(__file__).resolve().parent.parent / "logging.py"),
]
_real_paths: dict[str, str] = {}  # file name as in a code object -> real path


def _find_caller(frame: FrameType | None) -> FrameType:
    """Return the first frame, from this one outwards, that is not inside the logging code."""
    assert frame is not None
    while frame.f_back is not None:
        name = frame.f_code.co_filename
        path = _real_paths.get(name) or _real_paths.setdefault(name, os.path.realpath(name))
        if not any(internal in path for internal in _internal_callers):
            break
        frame = frame.f_back
    return frame


class _Caller(NamedTuple):
    function_name: str
    file_path: str
    line_number: int
    last_index: int  # tells two calls on one line apart


class CallerId(_Caller):
    """The place that called: function, file, line, and which call on that line."""

    __slots__ = ()

    def __new__(cls, frame: FrameType | None = None) -> CallerId:
        """Identify a frame; None: the caller outside the logging code."""
        place = _find_caller(sys._getframe()) if frame is None else frame
        code = place.f_code
        return super().__new__(
            cls, code.co_name, str(Path(code.co_filename).absolute()), place.f_lineno, place.f_lasti
        )


class RcutilsLogger:
    """A logger; get one by `rclpy.logging.get_logger` or `Node.get_logger`.

    Every call returns whether it logged.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.logger_sublogger_namepair: tuple[str, str] | None = None  # registered for /rosout
        self.contexts: dict[CallerId, dict[str, Any]] = {}

    def __del__(self) -> None:
        if self.logger_sublogger_namepair and _rclpy is not None:  # None: the interpreter is going down
            _rclpy.rclpy_logging_rosout_remove_sublogger(*self.logger_sublogger_namepair)
            self.logger_sublogger_namepair = None

    def get_child(self, name: str) -> RcutilsLogger:
        """Return a logger below this one; it publishes to /rosout if this one does.

        :raises ValueError: for an empty name.
        """
        if not name:
            raise ValueError("Child logger name must not be empty.")
        separator = _rclpy.rclpy_logging_get_separator_string()
        child = RcutilsLogger(name=self.name + separator + name if self.name else name)
        if self.name and _rclpy.rclpy_logging_rosout_add_sublogger(self.name, name):
            child.logger_sublogger_namepair = (self.name, name)
        return child

    def set_level(self, level: int | LoggingSeverity) -> None:
        """Set the level; UNSET inherits. ValueError if there is no such level."""
        _rclpy.rclpy_logging_set_logger_level(self.name, LoggingSeverity(level))

    def get_effective_level(self) -> LoggingSeverity:
        """Return the level, or the one that it inherits."""
        return LoggingSeverity(_rclpy.rclpy_logging_get_logger_effective_level(self.name))

    def is_enabled_for(self, severity: int | LoggingSeverity) -> bool:
        """Return whether messages of this severity are logged."""
        if type(severity) is not LoggingSeverity:  # an enum takes its time to find a member
            severity = LoggingSeverity(severity)
        return _rclpy.rclpy_logging_logger_is_enabled_for(self.name, severity)

    def log(self, message: str, severity: int | LoggingSeverity, **kwargs: Any) -> bool:
        """Log a message, unless its severity is below the logger's level or a filter holds it back.

        :param name: another logger name to show.
        :param once: let only the first message of this line through.
        :param skip_first: hold the first message of this line back.
        :param throttle_duration_sec: let a message of this line through when the last one is so long ago.
        :param throttle_time_source_type: the Clock that measures this.
        :return: whether it was logged.
        :raises TypeError: for other keywords, or a message that is not a str.
        :raises ValueError: if a line that has logged before asks for another severity, name or filters.
        """
        if not self.is_enabled_for(severity):
            return False
        severity = LoggingSeverity(severity)
        name = kwargs.pop("name", self.name)
        filters = get_filters_from_kwargs(**kwargs) if kwargs else []
        caller = CallerId()
        context = self.contexts.get(caller)
        if context is None:
            context = self.contexts[caller] = _new_context(severity, name, filters, kwargs)
        else:
            _must_not_differ(context, severity, name, filters, kwargs)
        if not all(supported_filters[known].should_log(context) for known in filters):
            return False
        _rclpy.rclpy_logging_rcutils_log(
            severity, name, message, caller.function_name, caller.file_path, caller.line_number
        )
        return True

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log with severity DEBUG; keywords as for `log`."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log with severity INFO; keywords as for `log`."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log with severity WARN; keywords as for `log`."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    def warn(self, message: str, **kwargs: Any) -> bool:
        """Do what `warning` does; the older name."""
        return self.warning(message, **kwargs)

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log with severity ERROR; keywords as for `log`."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log with severity FATAL; keywords as for `log`."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def _new_context(
    severity: LoggingSeverity, name: str, filters: list[str], kwargs: dict[str, Any]
) -> dict[str, Any]:
    context: dict[str, Any] = {"name": name, "severity": severity}
    for known in filters:
        supported_filters[known].initialize_context(context, **kwargs)
    context["filters"] = filters
    return context


def _must_not_differ(
    context: dict[str, Any], severity: LoggingSeverity, name: str, filters: list[str], kwargs: dict[str, Any]
) -> None:
    if severity != context["severity"]:
        raise ValueError("Logger severity cannot be changed between calls.")
    if name != context["name"]:
        raise ValueError("Logger name cannot be changed between calls.")
    if filters != context["filters"]:
        raise ValueError("Requested logging filters cannot be changed between calls.")
    for known in filters:
        for parameter, default in supported_filters[known].params.items():
            if context[parameter] != kwargs.get(parameter, default):
                raise ValueError("Logging filter parameters cannot be changed between calls.")
