"""Loggers as rcutils has them: levels by dotted name, one line a message on stderr, a file, and /rosout."""

from __future__ import annotations

import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from rmw_local import report, timing

from rclpy.impl import program
from rclpy.impl.messages import cleaned_text

from .log_outputs import Console, Line, LogFile
from .names import as_c_string
from .rosout import publish_to_rosout

if TYPE_CHECKING:
    from .context import Context
from .structs import ExtensionEnum

_SEVERITIES = {0: "UNSET", 10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
_INFO = 20


class RCUTILS_LOG_SEVERITY(ExtensionEnum):
    """The severity."""

    RCUTILS_LOG_SEVERITY_UNSET = 0
    RCUTILS_LOG_SEVERITY_DEBUG = 10
    RCUTILS_LOG_SEVERITY_INFO = 20
    RCUTILS_LOG_SEVERITY_WARN = 30
    RCUTILS_LOG_SEVERITY_ERROR = 40
    RCUTILS_LOG_SEVERITY_FATAL = 50


class _Levels:
    """The level of every logger that was given one, the default, and what loggers inherit from these."""

    def __init__(self) -> None:
        self.default = _INFO
        self._set: dict[str, int] = {}
        self._effective: dict[str, int] = {}  # cache; any change empties it
        self._lock = threading.Lock()

    def renew_lock(self) -> None:
        self._lock = threading.Lock()

    def get(self, name: str) -> int:
        return self._set.get(name, 0) if name else self.default

    def set(self, name: str, level: int) -> None:
        with self._lock:
            if name:
                self._set[name] = level
            else:
                self.default = level
            self._effective.clear()

    def effective(self, name: str) -> int:
        found = self._effective.get(name)
        if found is None:
            with self._lock:
                found = self._effective[name] = self._inherited(name)
        return found

    def _inherited(self, name: str) -> int:
        while name:
            if level := self._set.get(name, 0):
                return level
            name = name.rpartition(".")[0]
        return self.default


class _Logging:
    """The logging state of a program: levels, destinations, and a log file while a context is up."""

    def __init__(self) -> None:
        self.levels = _Levels()
        self.console: Console | None = None
        self.file: LogFile | None = None

    def renew_locks(self) -> None:
        """Free the locks in a fork."""
        self.levels.renew_lock()
        if self.file is not None:
            self.file.renew_lock()


def _here() -> _Logging:
    here = program.current()
    kept: _Logging | None = here.logging
    if kept is None:
        kept = here.logging = _Logging()
    return kept


def rclpy_logging_initialize() -> None:
    """Set up the output as the environment asks for it; further calls change nothing."""
    here = _here()
    if here.console is None:
        here.console = Console()


def rclpy_logging_shutdown() -> None:
    """Forget levels and output settings."""
    here = _here()
    here.console, here.levels = None, _Levels()


def rclpy_logging_configure(context: Context) -> None:
    """Apply the log levels and switches of a context's arguments, and log to a file from here on."""
    here = _here()
    rclpy_logging_initialize()
    arguments = context.arguments
    if arguments.default_log_level is not None:
        here.levels.set("", arguments.default_log_level)
    for name, level in arguments.log_levels.items():
        here.levels.set(name, level)
    _output().enabled = arguments.stdout_logs
    if arguments.external_lib_logs:
        here.file = LogFile(rclpy_logging_get_logging_directory(), arguments.log_file_prefix)


def rclpy_logging_fini() -> None:
    """Undo the switches of `rclpy_logging_configure` and end the file; levels stay."""
    here = _here()
    _output().enabled = True
    if here.file is not None:
        here.file.close()
        here.file = None


def rclpy_logging_get_separator_string() -> str:
    """The separator of the tokens of a logger name."""
    return "."


def rclpy_logging_get_logging_directory() -> str:
    """The folder for log files: ROS_LOG_DIR, or `log` in ROS_HOME or ~/.ros."""
    if directory := os.environ.get("ROS_LOG_DIR"):
        return str(Path(directory).expanduser())
    home = os.environ.get("ROS_HOME") or "~/.ros"
    return str(Path(home).expanduser() / "log")


def rclpy_logging_severity_level_from_string(name: str) -> int:
    """The number of a severity's name, in any case."""
    name = as_c_string(name, "Failed to get severity name", RuntimeError).upper()
    for level, known in _SEVERITIES.items():
        if known == name:
            return level
    raise RuntimeError("Failed to get severity name")


def rclpy_logging_set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set a logger's level; 0 lets it inherit."""
    if level not in _SEVERITIES:
        if detailed_error:
            raise RuntimeError("Failed reason: Unable to determine severity_string for severity")
        raise RuntimeError("Failed to set level for logger")
    _here().levels.set(as_c_string(name, "Failed to set level for logger", RuntimeError), int(level))


def rclpy_logging_get_logger_level(name: str) -> int:
    """The level that was set; 0 if none was."""
    return _here().levels.get(as_c_string(name, "Failed to get level for logger", RuntimeError))


def rclpy_logging_get_logger_effective_level(name: str) -> int:
    """The level that was set for it, or for its nearest ancestor that has one."""
    return _here().levels.effective(
        as_c_string(name, "Failed to get effective level for logger", RuntimeError)
    )


def rclpy_logging_logger_is_enabled_for(name: str, severity: int) -> bool:
    """Whether a message of this severity would be logged."""
    return severity >= _here().levels.effective(name)


def rclpy_logging_rcutils_log(
    severity: int, name: str, message: str, function_name: str, file_name: str, line_number: int
) -> None:
    """Write one message to the console, to the log file and, for loggers of nodes, to /rosout."""
    for text in (name, message, function_name, file_name):
        if not isinstance(text, str):
            raise TypeError(
                "rclpy_logging_rcutils_log(): incompatible function arguments: "
                f"name, message, function and file must be str, got {text!r}"
            )
    name, message, function_name, file_name = map(cleaned_text, (name, message, function_name, file_name))
    here = _here()
    if severity < here.levels.effective(name):
        return
    label = _SEVERITIES.get(severity)
    if label is None:
        _output().write_line(f"unknown severity level: {severity}")
        return
    stamp = timing.time_ns()
    console, file = _output(), here.file
    if console.enabled or file is not None:
        text = console.format(Line(label, name, message, function_name, file_name, line_number, stamp))
        console.write(int(severity), text)
        if file is not None:
            file.write_line(text)
    publish_to_rosout(int(severity), name, message, function_name, file_name, line_number, stamp)


def _output() -> Console:
    rclpy_logging_initialize()
    console = _here().console
    assert console is not None
    return console


def _log_as_node(node: str, text: str, is_warning: bool) -> None:
    """Log what the middleware has to say to a node."""
    severity = RCUTILS_LOG_SEVERITY.RCUTILS_LOG_SEVERITY_WARN if is_warning else _INFO
    rclpy_logging_rcutils_log(severity, node.strip("/").replace("/", "."), text, "", "", 0)


report.install(_log_as_node)
