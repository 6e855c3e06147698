"""The severity of a message."""

from __future__ import annotations

from enum import IntEnum


class LoggingSeverity(IntEnum):
    """The levels of rcutils; UNSET inherits."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50
