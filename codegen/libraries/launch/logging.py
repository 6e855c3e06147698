"""Loggers of a launch: the screen, the log files, and where the lines of processes go."""

from __future__ import annotations

import logging
import os
import socket
import sys
import time
from collections.abc import Mapping
from itertools import cycle
from pathlib import Path
from typing import IO, Any, Final

__all__ = [
    "LaunchConfig",
    "get_logger",
    "get_output_loggers",
    "launch_config",
    "log_launch_config",
    "normalize_output_configuration",
    "reset",
]

_COLOURS: Final = (36, 33, 35, 32, 34, 96, 93, 95, 92, 94)
_LEVELS: Final = {"WARNING": 33, "ERROR": 31, "CRITICAL": 31}
_COMMON: Final = "launch.log"
_FORMATS: Final = {
    "default": "[{levelname}] [{name}]: {message}",
    "default_with_timestamp": "{created:.7f} [{levelname}] [{name}]: {message}",
    "verbose": "{created:.7f} [{levelname}] [{name}]: {message}",
}
_SCREEN: Final = frozenset({"screen"})
_LOG: Final = frozenset({"log"})
_OWN: Final = frozenset({"own_log"})
_MODES: Final = {
    "screen": (_SCREEN, _SCREEN),
    "log": (_LOG, _SCREEN | _LOG),
    "both": (_SCREEN | _LOG, _SCREEN | _LOG),
    "own_log": (_OWN, _OWN),
    "full": (_SCREEN | _LOG | _OWN, _SCREEN | _LOG | _OWN),
}


class LaunchConfig:
    """The level, the folder, the screen and the files that all loggers of a launch share."""

    def __init__(self) -> None:
        self._names: set[str] = set()
        self._files: dict[str, IO[str]] = {}
        self.reset()

    def reset(self) -> None:
        """Forget the folder and the formats, close the files, and leave each logger without handlers."""
        self.close()
        for name in self._names:
            logging.getLogger(name).handlers.clear()
        self._names.clear()
        self._level = logging.INFO
        self._folder: Path | None = None
        self._colours = cycle(_COLOURS)
        self._of: dict[str, int] = {}
        self._screen_format, self._log_format = _FORMATS["default"], _FORMATS["default_with_timestamp"]
        self._screen = _Destination(self, on_screen=True)
        self._is_unread = False
        self._has_failed = False

    def close(self) -> None:
        """Close the log files, which open again when there is something to write."""
        for file in self._files.values():
            file.close()
        self._files.clear()

    @property
    def level(self) -> int:
        """The level of the loggers, as of Python's logging."""
        return self._level

    @level.setter
    def level(self, level: int) -> None:
        self._level = level
        for name in self._names:
            logging.getLogger(name).setLevel(level)

    @property
    def log_dir(self) -> str:
        """The folder of log files, made when somebody asks: by the variables of ROS, unless it is set."""
        if self._folder is None:
            stamp = time.strftime("%Y-%m-%d-%H-%M-%S")
            name = f"{stamp}-{time.time_ns() // 1000 % 1_000_000:06}-{socket.gethostname()}-{os.getpid()}"
            self._folder = _log_root() / name
        self._folder.mkdir(parents=True, exist_ok=True)
        return str(self._folder)

    @log_dir.setter
    def log_dir(self, folder: str) -> None:
        if self._files:
            raise RuntimeError("the folder of log files cannot change once there are some: call reset()")
        self._folder = Path(folder)

    def set_screen_format(self, screen_format: str, *, screen_style: str | None = None) -> None:
        """Choose the format on the screen: default, default_with_timestamp, verbose, or one with braces."""
        self._screen_format = _FORMATS.get(screen_format, screen_format)

    def set_log_format(self, log_format: str, *, log_style: str | None = None) -> None:
        """Choose the format in files, as `set_screen_format`."""
        self._log_format = _FORMATS.get(log_format, log_format)

    def get_screen_handler(self) -> logging.Handler:
        """Return the handler that prints on the screen."""
        return self._screen

    def get_log_file_path(self, file_name: str = _COMMON) -> str:
        """Return the path of a log file, which may not exist."""
        return str(Path(self.log_dir) / file_name)

    def get_log_file_handler(self, file_name: str = _COMMON) -> logging.Handler:
        """Return a handler that writes to a log file."""
        return _Destination(self, file=file_name)

    def say(self, record: logging.LogRecord, file: str) -> None:
        """Write a record to a file, or to the screen where the file has no name."""
        template = self._log_format if file else self._screen_format
        line = template.format(**{**vars(record), "message": record.getMessage(), "msg": record.getMessage()})
        if file:
            self.write(file, line)
            return
        colour = _LEVELS.get(record.levelname)
        self.show(f"\x1b[{colour}m{line}\x1b[0m" if colour and _is_coloured() else line)

    def line(self, process: str, text: str, places: frozenset[str], stream: str, common: str) -> None:
        """Write a line of a process to its places."""
        if "screen" in places:
            prefix = f"[{process}]"
            if _is_coloured():
                colour = self._of.setdefault(process, self._of.get(process) or next(self._colours))
                prefix = f"\x1b[{colour}m{prefix}\x1b[0m"
            self.show(f"{prefix} {text}")
        if "log" in places:
            self.write(common, f"{time.time():.7f} [{process}] {text}")
        if "own_log" in places:
            self.write(f"{process}-{stream}.log", text)
            self.write(f"{process}.log", text)

    def show(self, line: str) -> None:
        """Print a line, if somebody reads it."""
        if self._is_unread:
            return
        try:
            sys.stdout.write(f"{line}\n")
            sys.stdout.flush()
        except (BrokenPipeError, ValueError):  # `| head -1`: nodes go on without a reader
            self._is_unread = True
            sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - to the end of the process

    def write(self, name: str, line: str) -> None:
        """Add a line to a log file."""
        if self._has_failed:
            return
        try:
            if name not in self._files:
                path = Path(self.get_log_file_path(name))
                self._files[name] = path.open("a", encoding="utf-8", errors="replace")
            self._files[name].write(f"{line}\n")
            self._files[name].flush()
        except OSError as error:  # a full disk is no reason to stop a robot
            self._has_failed = True
            self.show(f"[WARNING] [launch]: no log files from here on: {error}")

    def logger(self, name: str, *handlers: logging.Handler) -> logging.Logger:
        """Return the logger of a name, with these handlers unless it has some."""
        logger = logging.getLogger(name)
        if name not in self._names:
            self._names.add(name)
            logger.propagate = False
            logger.setLevel(self._level)
            logger.handlers[:] = handlers
        return logger


class _Destination(logging.Handler):
    """The screen, or a file."""

    def __init__(self, config: LaunchConfig, *, on_screen: bool = False, file: str = "") -> None:
        super().__init__()
        self._config = config
        self._file = "" if on_screen else file

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record."""
        self._config.say(record, self._file)


class _Lines(logging.Handler):
    """The places that one stream of a process goes to."""

    def __init__(
        self, config: LaunchConfig, process: str, stream: str, places: frozenset[str], common: str
    ) -> None:
        super().__init__()
        self._config = config
        self._place = (places, stream, common)
        self._process = process

    def emit(self, record: logging.LogRecord) -> None:
        """Write a line."""
        self._config.line(self._process, record.getMessage(), *self._place)


launch_config: Final = LaunchConfig()
"""The configuration of the loggers in this process."""


def get_logger(name: str | None = None) -> logging.Logger:
    """Return the logger of this name, by default the one of the launch."""
    config = launch_config
    return config.logger(name or "launch", config.get_screen_handler(), config.get_log_file_handler())


def get_output_loggers(
    process_name: str, output_config: str | Mapping[str, Any], main_log_file_name: str = _COMMON
) -> tuple[logging.Logger, logging.Logger]:
    """Return the loggers of stdout and of stderr of a process. Raises ValueError."""
    config = normalize_output_configuration(output_config)
    stdout, stderr = (
        launch_config.logger(
            f"{process_name}-{stream}",
            _Lines(launch_config, process_name, stream, config[stream], main_log_file_name),
        )
        for stream in ("stdout", "stderr")
    )
    return stdout, stderr


def normalize_output_configuration(config: str | Mapping[str, Any]) -> dict[str, frozenset[str]]:
    """Return the places of stdout and stderr: screen, log (the common file), own_log. Raises ValueError."""
    if isinstance(config, str):
        if config not in _MODES:
            raise ValueError(f"output must be one of {', '.join(_MODES)}, got '{config}'")
        stdout, stderr = _MODES[config]
        return {"stdout": stdout, "stderr": stderr}
    streams = {name: _of_stream(value) for name, value in config.items()}
    unknown = streams.keys() - {"stdout", "stderr", "both"}
    if unknown:
        raise ValueError(
            f"output has no stream '{min(map(str, unknown))}': there are stdout, stderr and both"
        )
    both = streams.get("both", frozenset())
    return {name: streams.get(name, frozenset()) | both for name in ("stdout", "stderr")}


def _of_stream(value: Any) -> frozenset[str]:
    places: frozenset[str] = frozenset({value} if isinstance(value, str) else value)
    unknown = places - {"screen", "log", "own_log"}
    if unknown:
        raise ValueError(f"output has no place '{min(unknown)}': there are screen, log and own_log")
    return places


def log_launch_config(*, logger: logging.Logger | None = None) -> None:
    """Say where the log files are."""
    (logger or get_logger()).info(f"All log files can be found below {launch_config.log_dir}")


def reset() -> None:
    """Begin again, as if no logger had been asked for."""
    launch_config.reset()


def _is_coloured() -> bool:
    return sys.stdout.isatty() and "NO_COLOR" not in os.environ


def _log_root() -> Path:
    """The folder for logs, by the variables of ROS."""
    if folder := os.environ.get("ROS_LOG_DIR"):
        return Path(folder).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"
