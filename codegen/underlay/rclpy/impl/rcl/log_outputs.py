"""The places that log messages go to: the console, in rcutils' format, and the log file of a process."""

from __future__ import annotations

import _thread
import os
import re
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from rmw_local import timing

DEFAULT_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_COLOURS = {10: "\033[32m", 20: "\033[0m", 30: "\033[33m", 40: "\033[31m", 50: "\033[31m"}
_NO_COLOUR = "\033[0m"
_ESCAPES = {
    "n": "\n",
    "t": "\t",
    "r": "\r",
    "a": "\a",
    "b": "\b",
    "f": "\f",
    "v": "\v",
    "\\": "\\",
    "'": "'",
    '"': '"',
}


@dataclass(slots=True)
class Line:
    """A message with what the tokens of a format can show; `stamp` is the system time [ns]."""

    severity: str
    name: str
    message: str
    function: str
    file: str
    line: int
    stamp: int

    def date_time(self) -> str:
        """The stamp as local time with ms."""
        seconds, rest = divmod(self.stamp, 10**9)
        return f"{time.strftime('%Y-%m-%d %H:%M:%S', time.localtime(seconds))}.{rest // 10**6:03}"


_TOKENS: dict[str, Callable[[Line], str]] = {
    "severity": lambda line: line.severity,
    "name": lambda line: line.name,
    "message": lambda line: line.message,
    "function_name": lambda line: line.function,
    "file_name": lambda line: line.file,
    "line_number": lambda line: str(line.line),
    "time": lambda line: f"{line.stamp // 10**9}.{line.stamp % 10**9:09}",
    "time_as_nanoseconds": lambda line: str(line.stamp),
    "date_time_with_ms": Line.date_time,
}


class Console:
    """Writes log messages as the environment asks: RCUTILS_CONSOLE_OUTPUT_FORMAT, RCUTILS_COLORIZED_OUTPUT,
    RCUTILS_LOGGING_USE_STDOUT. Raises nothing for a stream that is closed or missing.
    """  # noqa: D205 - one sentence

    def __init__(self) -> None:
        self.enabled = True
        self._format = _parse(os.environ.get("RCUTILS_CONSOLE_OUTPUT_FORMAT") or DEFAULT_FORMAT)
        self._use_stdout = _switch("RCUTILS_LOGGING_USE_STDOUT") or False
        self._colours = _switch("RCUTILS_COLORIZED_OUTPUT")  # None: if it is a terminal

    def format(self, line: Line) -> str:
        """Show a message as the format says, without colour."""
        return "".join([part if isinstance(part, str) else part(line) for part in self._format])

    def write(self, level: int, text: str) -> None:
        """Write one message, in the colour of its severity where there are colours."""
        if self.enabled:
            self.write_line(f"{_COLOURS[level]}{text}{_NO_COLOUR}" if self._is_coloured() else text)

    def write_line(self, text: str) -> None:
        """Write a line, whole even if several threads write."""
        stream = self._stream()
        if stream is not None and not stream.closed:
            try:
                stream.write(text + "\n")
            except UnicodeEncodeError as error:  # such as ASCII, which has no accents
                stream.write(text.encode(error.encoding, "backslashreplace").decode(error.encoding) + "\n")
            stream.flush()

    def _stream(self) -> TextIO | None:
        return sys.stdout if self._use_stdout else sys.stderr

    def _is_coloured(self) -> bool:
        if self._colours is not None:
            return self._colours
        stream = self._stream()
        return stream is not None and not stream.closed and stream.isatty()


def _parse(text: str) -> list[str | Callable[[Line], str]]:
    """Split a format into literal text and tokens; unknown tokens and escapes stay as they are."""
    parts: list[str | Callable[[Line], str]] = []
    for piece in re.split(r"(\{\w+\}|\\.)", text):
        if piece.startswith("{") and piece[1:-1] in _TOKENS:
            parts.append(_TOKENS[piece[1:-1]])
        elif piece.startswith("\\"):
            parts.append(_ESCAPES.get(piece[1:], piece))
        else:
            parts.append(piece)
    return parts


def _switch(variable: str) -> bool | None:
    """Read a variable that may be 0 or 1; None if it is not set."""
    value = os.environ.get(variable, "")
    if value not in ("", "0", "1"):
        raise RuntimeError(f"unexpected value [{value}] specified for {variable}. Valid values are 0 or 1.")
    return None if not value else value == "1"


class LogFile:
    """The file `<program>_<process id>_<time [ms]>.log`, which takes lines while a context is up.

    It is made for the first line, so silent programs leave none.

    :param directory: made if it is missing.
    :param program: how the file name begins; None for the name of the process's program.
    """

    def __init__(self, directory: str, program: str | None) -> None:
        name = program or Path(sys.orig_argv[0]).name or "python"
        self._path = Path(directory) / f"{name}_{os.getpid()}_{timing.time_ns() // 10**6}.log"
        self._descriptor: int | None = None
        self._is_closed = False
        # Not threading's, which virtual time exchanges: threads that an earlier one has left over may write.
        # Reentrant, because a signal handler may log too.
        self._lock = _thread.RLock()

    def renew_lock(self) -> None:
        """Free the lock in a fork."""
        self._lock = _thread.RLock()

    def write_line(self, text: str) -> None:
        """Append a line, whole even if several threads write. Where there can be no file, say so once."""
        with self._lock:
            try:
                descriptor = self._open()
                if descriptor is not None:
                    os.write(descriptor, f"{text}\n".encode(errors="surrogateescape"))
            except OSError as error:
                self.close()
                print(f"rclpy: the log goes to no file any more: {error}", file=sys.stderr)

    def close(self) -> None:
        """End it; further lines go nowhere."""
        with self._lock:
            descriptor, self._descriptor = self._descriptor, None
            self._is_closed = True
            if descriptor is not None:
                os.close(descriptor)

    def _open(self) -> int | None:
        if self._descriptor is None and not self._is_closed:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        return self._descriptor
