"""What a node has refused, for whoever looks at /diagnostics."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from . import messages


class Health:
    """One part of a node: in order, or it has refused something of late, or it has a problem."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._told = 0

    def report(
        self, stamp: int, counts: Mapping[str, int], refused: str, problem: str = ""
    ) -> DiagnosticArray:
        """All that was ever refused, by reason; `refused` is why the last one was, in words.

        The level is ERROR while there is a problem, WARN if something was refused since the last report.
        """
        total = sum(counts.values())
        news, self._told = total > self._told, total
        level, words = DiagnosticStatus.OK, "everything was taken since the last report"
        if problem:
            level, words = DiagnosticStatus.ERROR, problem
        elif news:
            level, words = DiagnosticStatus.WARN, refused
        values = [KeyValue(key=key, value=str(count)) for key, count in counts.items()]
        status = DiagnosticStatus(level=level, name=self._name, message=words, values=values)
        return DiagnosticArray(header=messages.header(stamp, ""), status=[status])
