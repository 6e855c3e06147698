"""The lines of a launch: on the screen, with the name of each process, and in log files."""

from __future__ import annotations

import logging
import os
import socket
import sys
import time
from itertools import cycle
from pathlib import Path
from typing import IO, Final

_COLOURS: Final = (36, 33, 35, 32, 34, 96, 93, 95, 92, 94)
_LEVELS: Final = {"WARNING": 33, "ERROR": 31}


class Output:
    """Prints the lines of processes, each with its prefix, and what the launch itself says."""

    def __init__(self) -> None:
        self._colours = cycle(_COLOURS)
        self._of: dict[str, int] = {}
        self._files: dict[str, IO[str]] = {}
        self._folder: Path | None = None
        self._is_coloured = sys.stdout.isatty() and "NO_COLOR" not in os.environ
        self._is_closed = False
        self._has_failed = False

    @property
    def folder(self) -> Path:
        """The folder of log files, made when somebody asks."""
        if self._folder is None:
            stamp = time.strftime("%Y-%m-%d-%H-%M-%S")
            name = f"{stamp}-{time.time_ns() // 1000 % 1_000_000:06}-{socket.gethostname()}-{os.getpid()}"
            self._folder = _log_root() / name
            self._folder.mkdir(parents=True, exist_ok=True)
        return self._folder

    def log(self, level: str, name: str, text: str) -> None:
        """Print a line about the launch, and keep it."""
        line = f"[{level}] [{name}]: {text}"
        colour = _LEVELS.get(level)
        self._screen(f"\x1b[{colour}m{line}\x1b[0m" if colour and self._is_coloured else line)
        self._file("launch.log", f"{time.time():.7f} {line}")

    def line(self, process: str, text: str, places: frozenset[str], stream: str) -> None:
        """Print a line of a process where its lines go."""
        if "screen" in places:
            prefix = f"[{process}]"
            if self._is_coloured:
                colour = self._of.setdefault(process, self._of.get(process) or next(self._colours))
                prefix = f"\x1b[{colour}m{prefix}\x1b[0m"
            self._screen(f"{prefix} {text}")
        if "log" in places:
            self._file("launch.log", f"{time.time():.7f} [{process}] {text}")
        if "own_log" in places:
            self._file(f"{process}-{stream}.log", text)
            self._file(f"{process}.log", text)

    def close(self) -> None:
        """Close the log files."""
        for file in self._files.values():
            file.close()
        self._files.clear()

    def _screen(self, line: str) -> None:
        if self._is_closed:
            return
        try:
            print(line, flush=True)
        except (BrokenPipeError, ValueError):  # `| head -1`: nodes go on without a reader
            self._is_closed = True
            sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - to the end of the process

    def _file(self, name: str, line: str) -> None:
        if self._has_failed:
            return
        try:
            if name not in self._files:
                self._files[name] = (self.folder / name).open("a", encoding="utf-8", errors="replace")
            self._files[name].write(f"{line}\n")
            self._files[name].flush()
        except OSError as error:  # a full disk is no reason to stop a robot
            self._has_failed = True
            self._screen(f"[WARNING] [launch]: no log files from here on: {error}")


class LogHandler(logging.Handler):
    """Prints what launch files log with `launch.logging`."""

    def __init__(self, output: Output) -> None:
        super().__init__()
        self._output = output

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record."""
        self._output.log(record.levelname, record.name, record.getMessage())


def _log_root() -> Path:
    """The folder for logs, by the variables of ROS."""
    if folder := os.environ.get("ROS_LOG_DIR"):
        return Path(folder).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"
