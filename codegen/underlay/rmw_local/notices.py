"""Lines of the middleware for whoever reads a program's stderr."""

from __future__ import annotations

import _thread
import sys

from rmw_local import timing

_SECOND = 1_000_000_000  # [ns]


def say(text: str) -> None:
    """Print one line on stderr, if there is one (pythonw has none)."""
    if sys.stderr is not None:
        sys.stderr.write(f"rmw_local: {text}\n")


class Repeated:
    """Something that may happen often, and is said at most once a second: others must not fill a log.

    `text` has holes for `{count}`, a plural `{s}` and the reason `{why}` of the last time.
    """

    def __init__(self, text: str) -> None:
        self.count = 0
        """The number of times that it happened."""
        self._text = text
        self._untold = 0
        self._told: int | None = None  # in which second
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges

    def add(self, why: str = "") -> None:
        """Count one more, and say all since the last line, unless that was less than a second ago."""
        second = timing.monotonic_ns() // _SECOND
        with self._lock:
            self.count += 1
            self._untold += 1
            if second == self._told:
                return
            self._told = second
            count, self._untold = self._untold, 0
        say(self._text.format(count=count, s="" if count == 1 else "s", why=why))
