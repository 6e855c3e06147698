"""Tells of payloads that were dropped because they are no message of their type."""

from __future__ import annotations

import _thread
import sys

from rmw_local import timing

_SECOND = 1_000_000_000  # [ns]


class Drops:
    """Counts the payloads of one type that could not be read; `type_name` is `pkg/kind/Name`.

    One line on stderr reports them, at most once a second: a peer must not be able to fill a log. The type
    support for real rclpy does the same, in the same words.
    """

    def __init__(self, type_name: str) -> None:
        self._type_name = type_name.replace("/", "::")
        self._untold = 0
        self._told: int | None = None  # in which second
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def add(self) -> None:
        """Count one more, and report all since the last line, unless that was less than a second ago."""
        second = timing.monotonic_ns() // _SECOND
        with self._lock:
            self._untold += 1
            if second == self._told:
                return
            self._told = second
            count, self._untold = self._untold, 0
        if sys.stderr is not None:  # pythonw has none
            plural = "" if count == 1 else "s"
            sys.stderr.write(
                f"rmw_local: dropped {count} malformed message{plural} of type {self._type_name} "
                "(does a publisher have another definition of it?)\n"
            )
