"""A status with methods that fill it."""

from __future__ import annotations

from typing import Any, overload

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue


class DiagnosticStatusWrapper(DiagnosticStatus):
    """The status that a task fills. Levels are bytes: `DiagnosticStatus.OK`, WARN, ERROR or STALE."""

    @overload
    def summary(self, status: DiagnosticStatus, /) -> None: ...
    @overload
    def summary(self, level: bytes, message: object, /) -> None: ...
    def summary(self, *arguments: Any) -> None:
        """Set level and message, or take both over from another status."""
        self.level, self.message = _level_and_message(arguments)

    def clearSummary(self) -> None:
        """Set the level to OK and remove the message."""
        self.summary(DiagnosticStatus.OK, "")

    @overload
    def mergeSummary(self, status: DiagnosticStatus, /) -> None: ...
    @overload
    def mergeSummary(self, level: bytes, message: object, /) -> None: ...
    def mergeSummary(self, *arguments: Any) -> None:
        """Keep the worse level. Messages of two problems are joined; a problem's replaces that of an OK."""
        level, message = _level_and_message(arguments)
        if (level == DiagnosticStatus.OK) == (self.level == DiagnosticStatus.OK):
            self.message = f"{self.message}; {message}" if self.message else message
        elif level > self.level:
            self.message = message
        self.level = max(level, self.level)

    def add(self, key: str, value: object) -> None:
        """Add a key with the text of a value."""
        values: Any = self.values
        values.append(KeyValue(key=key, value=str(value)))


def _level_and_message(arguments: tuple[Any, ...]) -> tuple[bytes, str]:
    """The two parts of what `summary` and `mergeSummary` get. Raises TypeError for anything else."""
    if len(arguments) == 1:
        arguments = (arguments[0].level, arguments[0].message)
    if len(arguments) != 2:
        raise TypeError(f"expected a status, or a level and a message, got {len(arguments)} arguments")
    level, message = arguments
    if not isinstance(level, bytes) or len(level) != 1:
        raise TypeError(f"a level is a byte such as DiagnosticStatus.WARN, not {level!r}")
    return level, str(message)
