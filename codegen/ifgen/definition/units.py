"""Texts that look like a physical unit, as comments in interfaces write them."""

from __future__ import annotations

import re
from typing import Final

_PREFIXED: Final = frozenset("m g s A K N J W V F T H C L Pa Hz rad bar Ah Wh eV Ohm \u03a9 lx lm".split())  # noqa: SIM905
_PREFIXES: Final = ("G", "M", "k", "h", "d", "c", "m", "u", "\u00b5", "\u03bc", "n", "p", "")
_WORDS: Final = frozenset(
    """
    deg min h hr sec msec usec nsec rpm px dB dBm bps kbps Mbps kB KB MB lb ft mi kn kt Nm Ga Gs degC degF
    meter metre second minute hour degree radian percent pixel newton kelvin celsius gram watt volt ampere
    hertz joule knot gauss tesla pascal feet inch mile millimeter centimeter kilometer millisecond
    microsecond nanosecond
    """.split()  # noqa: SIM905  # a list of fifty strings is harder to read
)
"""Without those that are as often an index: `bit`, `byte`, `in`."""

_BETWEEN: Final = re.compile(r"[\s*/^\u00b7.()+-]|\d+|\*\*|\bper\b")
_SIGNS: Final = frozenset("%\u00b0\u2103")


def is_unit(text: str) -> bool:
    """Whether a text is made of names of units: `rad`, `m/s^2`, `milliseconds`; not `i`, and not `0`."""
    parts = [part for part in _BETWEEN.split(text) if part]
    return bool(parts) and all(map(_is_name, parts))


def _is_name(part: str) -> bool:
    if part in _SIGNS or part in _WORDS or part.lower().removesuffix("s") in _WORDS:
        return True
    return any(part.startswith(prefix) and part[len(prefix) :] in _PREFIXED for prefix in _PREFIXES)
