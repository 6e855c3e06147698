"""Figures as short texts."""

from __future__ import annotations

from typing import Final

UNKNOWN: Final = "-"
_PREFIXES: Final = ("", "k", "M", "G", "T")
_CUT: Final = "~"  # every terminal has it


def amount(value: float | None) -> str:
    """A number with three or four digits: `12.3`, `4.56k`."""
    if value is None:
        return UNKNOWN
    scaled, prefix = value, ""
    for prefix in _PREFIXES:  # noqa: B007  # the last one is used
        if scaled < 999.5:
            break
        scaled /= 1000
    digits = 0 if scaled >= 99.95 or not scaled else 1 if scaled >= 9.995 else 2
    return f"{scaled:.{digits}f}{prefix}"


def count(value: int | None) -> str:
    """A whole number."""
    return UNKNOWN if value is None else str(value)


def percent(value: float | None) -> str:
    """A part of one in percent."""
    return UNKNOWN if value is None else f"{100 * value:.0f}%"


def duration(seconds: float) -> str:
    """A time in the unit that fits: `850us`, `12.3ms`, `1.50s`."""
    if not seconds:
        return UNKNOWN
    if seconds < 1e-3:
        return f"{1e6 * seconds:.0f}us"
    if seconds < 1:
        return f"{1e3 * seconds:.1f}ms"
    return f"{seconds:.2f}s"


def queue(waiting: int, depth: int) -> str:
    """The number of waiting messages, and the most that can wait: `3/10`."""
    return f"{waiting}/{depth}" if depth else f"{waiting}/-"


def shortened(text: str, width: int) -> str:
    """The text in `width` characters: the end of a name says more than its middle."""
    if len(text) <= width:
        return text
    head = max(width // 3, 1)
    return f"{text[:head]}{_CUT}{text[len(text) - (width - head - 1) :]}"[:width]
