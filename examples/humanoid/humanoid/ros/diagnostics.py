"""The refusals of a node: counted, logged, and published on /diagnostics."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from . import messages

Value = TypeVar("Value")

UNANSWERED = "steps without set-points"
"""The key of the simulator's diagnostics that counts them: a run with any is not reproducible."""

_PAUSE = 1.0  # s of real time between two lines about the same kind


class Health:
    """The health of one part of a node: in order, has refused something lately, or has a problem."""

    def __init__(self, name: str, logger: Any, *kinds: str) -> None:
        """Count refusals; `kinds` names what can be refused, such as `plans`."""
        self.counts = dict.fromkeys(kinds, 0)
        self._name = name
        self._logger = logger
        self._said = dict.fromkeys(kinds, -_PAUSE)
        self._reason = ""  # why something was last refused
        self._told = 0

    def takes(self, kind: str, problem: str) -> bool:
        """Whether there is no problem; if there is one, the refusal is counted and logged."""
        if problem:
            self.counts[kind] += 1
            self._reason = problem
            # The logger's own throttle would let one kind drown out the others.
            now = time.monotonic()
            if now - self._said[kind] >= _PAUSE:
                self._said[kind] = now
                self._logger.warning(f"{kind} refused ({self.counts[kind]} so far): {problem}")
        return not problem

    def read(self, kind: str, topic: str, reader: Callable[..., Value], *message: Any) -> Value | None:
        """Read a message; None if the reader raises ValueError, which is a refusal like any other."""
        try:
            return reader(*message)
        except ValueError as error:
            self.takes(kind, f"{topic}: {error}")
            return None

    def report(
        self, stamp: int, problem: str = "", others: Mapping[str, int] | None = None
    ) -> DiagnosticArray:
        """The number of all refusals so far, by kind, with the counts of `others`.

        The level is ERROR while there is a problem, WARN if something was refused since the last report.
        """
        counts = self.counts | dict(others or {})
        total = sum(counts.values())
        news, self._told = total > self._told, total
        level, words = DiagnosticStatus.OK, "nothing was refused since the last report"
        if problem:
            level, words = DiagnosticStatus.ERROR, problem
        elif news:
            level, words = DiagnosticStatus.WARN, self._reason
        values = [KeyValue(key=key, value=str(count)) for key, count in counts.items()]
        status = DiagnosticStatus(level=level, name=self._name, message=words, values=values)
        return DiagnosticArray(header=messages.header(stamp, ""), status=[status])
