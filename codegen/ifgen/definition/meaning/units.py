"""Units of measurement as people write them: `m/s`, `m/sec` and `metres per second` are one.

There is no arithmetic here. `normal` brings a unit into one spelling, for equality, and `dimension` says what
it measures, for the question whether two units differ in scale only.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Final

NO_UNIT: Final = "-"
"""How PX4's standard spells that a number has no unit: `[-]`."""

Powers = dict[str, int]
"""Symbols with their exponents; those with 0 are left out."""

_PREFIXED: Final = frozenset(
    """
    m g s A K N J W V F T H C L Pa Hz rad bar Ah Wh eV Ohm lx lm bps B
    """.split()  # noqa: SIM905  # a list of thirty strings is harder to read
)
_PREFIXES: Final = ("G", "M", "k", "h", "d", "c", "m", "u", "n", "p", "Ki", "Mi", "K")
_ALONE: Final = frozenset(
    """
    deg degC degF min h rpm px % dB dBm lb ft mi kn in gauss b kb Kb Mb Gb cell count
    """.split()  # noqa: SIM905  # a list of thirty strings is harder to read
)
_DERIVED: Final[Mapping[str, str]] = {
    **{"N": "kg m/s^2", "J": "N m", "W": "J/s", "Pa": "N/m^2", "bar": "Pa", "V": "W/A", "Ohm": "V/A"},
    **{"C": "A s", "F": "C/V", "T": "V s/m^2", "H": "V s/A", "Hz": "1/s", "L": "m^3", "Ah": "A s", "Wh": "J"},
    **{"eV": "J", "deg": "rad", "rpm": "rad/s", "min": "s", "h": "s", "degC": "K", "degF": "K", "lb": "g"},
    **{"ft": "m", "in": "m", "mi": "m", "kn": "m/s", "%": "1", "dBm": "dB", "B": "b", "bps": "b/s"},
    **{"gauss": "T", "kb": "b", "Kb": "b", "Mb": "b", "Gb": "b"},
}
_NAMES: Final[Mapping[str, str]] = {
    **{"meter": "m", "metre": "m", "gram": "g", "second": "s", "sec": "s", "minute": "min", "hour": "h"},
    **{"hr": "h", "ampere": "A", "amp": "A", "kelvin": "K", "newton": "N", "joule": "J", "watt": "W"},
    **{"volt": "V", "farad": "F", "tesla": "T", "henry": "H", "coulomb": "C", "litre": "L", "liter": "L"},
    **{"pascal": "Pa", "hertz": "Hz", "hz": "Hz", "radian": "rad", "ohm": "Ohm", "lumen": "lm"},
    **{"degree": "deg", "celsius": "degC", "fahrenheit": "degF", "percent": "%", "pixel": "px", "knot": "kn"},
    **{"foot": "ft", "feet": "ft", "inch": "in", "inches": "in", "mile": "mi", "pound": "lb", "byte": "B"},
    **{
        "kt": "kn",
        "gs": "gauss",
        "ga": "gauss",
        "gauss": "gauss",
        "cell": "cell",
        "count": "count",
        "bit": "b",
        "mah": "mAh",
    },
}
_SCALES: Final[Mapping[str, str]] = {
    **{"giga": "G", "mega": "M", "kilo": "k", "centi": "c", "milli": "m", "micro": "u", "nano": "n"},
}
_SIGNS: Final = {
    **{"\u00b5": "u", "\u03bc": "u", "\u03a9": "Ohm", "\u2126": "Ohm", "\u00b2": "^2", "\u00b3": "^3"},
    **{"\u2103": "degC", "\u00b0C": "degC", "\u00b0F": "degF", "\u00b0": "deg", "**": "^", "\u00b7": "*"},
    **{" squared": "^2", " cubed": "^3", " per ": "/"},
}
_TEMPERATURE: Final = re.compile(r"\bdeg(?:rees?)?\s+(?:(C)(?:elsius)?|(F)(?:ahrenheit)?)\b", re.IGNORECASE)
_TOKEN: Final = re.compile(r"\s*(?:([^\W\d_]+|%)|(\d+)|([*./^()-])|(?=\s*\Z))")
_BETWEEN: Final = re.compile(r"[\s*/^\u00b7.()+-]|\d+|\*\*|\bper\b")
_INDICES: Final = frozenset({"in", "b", "B", "bit", "bits", "byte", "bytes", "cell", "cells", "count"})
"""The names that are as often those of an index: `data[byte]`."""
_LONGEST: Final = 60
"""The length in characters after which a text is no unit."""


def is_unit(text: str) -> bool:
    """Whether a text is made of names of units: `rad`, `m/s^2`, `milliseconds`; not `i`, and not `0`."""
    parts = [part for part in _BETWEEN.split(_plain(text)) if part]
    return bool(parts) and all(_symbol(part) and part not in _INDICES for part in parts)


@lru_cache(maxsize=1024)
def normal(text: str) -> str | None:
    """The one spelling of a unit: `m/s` for `metres per second`; None if the text is no unit.

    The symbols are in alphabetical order, with those that are divided by after them: `kg*m^2/s^2`.
    """
    powers = _powers(text)
    return None if powers is None else _spelled(powers)


@lru_cache(maxsize=1024)
def dimension(text: str) -> str | None:
    """The quantity of a unit in base units: `rad` for `deg`, `m/s` for `km/h`; None if it is unknown."""
    powers = _powers(text)
    return None if powers is None else _spelled(_bases(powers))


def _plain(text: str) -> str:
    """The text in ASCII, with the operators of `_product`."""
    text = _TEMPERATURE.sub(lambda match: "degC" if match[1] else "degF", text)
    for sign, plain in _SIGNS.items():
        text = text.replace(sign, plain)
    return text


def _powers(text: str) -> Powers | None:
    """The symbols of a unit with their exponents; None if something in it is unknown."""
    if text.strip() == NO_UNIT:
        return {}
    if not text.strip() or len(text) > _LONGEST:
        return None
    tokens: list[str] = []
    position, plain = 0, _plain(text)
    while position < len(plain):
        match = _TOKEN.match(plain, position)
        if match is None:
            return None
        tokens += filter(None, match.groups())
        position = max(match.end(), position + 1)
    powers = _product(tokens)
    return None if tokens else powers


def _product(tokens: list[str]) -> Powers | None:
    """Read a product, up to a `)`, and remove its tokens. A `/` divides by the next factor only, as in SI."""
    found: Powers = {}
    sign, is_due = 1, True
    while tokens and tokens[0] != ")":
        token = tokens.pop(0)
        if token in {"*", ".", "-", "/"}:
            if is_due:
                return None
            sign, is_due = -1 if token == "/" else 1, True
            continue
        factor = _product(tokens) if token == "(" else {} if token == "1" else _factor(token)
        if factor is None or (token == "(" and (not tokens or tokens.pop(0) != ")")):
            return None
        exponent = 1 if token == "1" else _exponent(tokens)
        if exponent is None:
            return None
        _add(found, factor, sign * exponent)
        sign, is_due = 1, False
    return None if is_due else found


def _factor(name: str) -> Powers | None:
    symbol = _symbol(name)
    return {"N": 1, "m": 1} if name == "Nm" else {symbol: 1} if symbol else None


def _exponent(tokens: list[str]) -> int | None:
    """The exponent of what stands before, 1 where there is none: `^2`, `^-1`, `-1`, `2`."""
    is_marked = tokens[:1] == ["^"]
    rest = tokens[is_marked:]
    sign = -1 if rest[:1] == ["-"] and rest[1:2] and rest[1].isdigit() else 1
    digits = rest[sign < 0 :][:1]
    if not digits or not digits[0].isdigit():
        return None if is_marked else 1
    del tokens[: is_marked + (sign < 0) + 1]
    return sign * int(digits[0][:2])


def _symbol(name: str) -> str | None:
    """The symbol of a name, with its prefix: `us` for `microseconds` and `usec`; None if it is unknown."""
    if name in _ALONE or name in _PREFIXED or name == "Nm":
        return name
    if any(name.startswith(prefix) and name[len(prefix) :] in _PREFIXED for prefix in _PREFIXES):
        return name
    return _word(name.lower()) or _word(name.lower().removesuffix("s"))


def _word(name: str) -> str | None:
    for scale, prefix in _SCALES.items():
        if (symbol := _NAMES.get(name.removeprefix(scale))) in _PREFIXED and name.startswith(scale):
            return f"{prefix}{symbol}"
    if name.endswith("sec") and name[:-3] in {"m", "u", "n"}:
        return f"{name[:-3]}s"
    return _NAMES.get(name)


def _bases(powers: Powers) -> Powers:
    found: Powers = {}
    for name, power in powers.items():
        is_whole = name in _PREFIXED or name in _ALONE
        symbol = name if is_whole else next(name[len(p) :] for p in _PREFIXES if _is_prefix(p, name))
        derived = _DERIVED.get(symbol)
        _add(found, {symbol: 1} if derived is None else _bases(_powers(derived) or {}), power)
    return found


def _is_prefix(prefix: str, name: str) -> bool:
    return name.startswith(prefix) and name[len(prefix) :] in _PREFIXED


def _add(powers: Powers, others: Powers, times: int) -> None:
    for name, power in others.items():
        powers[name] = powers.get(name, 0) + power * times
        if not powers[name]:
            del powers[name]


def _spelled(powers: Powers) -> str:
    above = "*".join(_raised(name, power) for name, power in sorted(powers.items()) if power > 0)
    below = [_raised(name, -power) for name, power in sorted(powers.items()) if power < 0]
    return "/".join([above or "1", *below]) if above or below else NO_UNIT


def _raised(name: str, power: int) -> str:
    return name if power == 1 else f"{name}^{power}"
