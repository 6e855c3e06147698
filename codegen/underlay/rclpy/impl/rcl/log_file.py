"""The log file of a process: `<program>_<process id>_<time [ms]>.log` in the logging directory."""

from __future__ import annotations

import _thread
import os
import sys
from pathlib import Path

from rmw_local import timing


class LogFile:
    """Takes lines while a context is up; its file is made for the first one, so silent programs leave none.

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
