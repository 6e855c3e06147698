"""The tags of PX4's standard: `[@range 0, 3]`, `[@enum MODE]`, `[@frame NED]`, `[@invalid NaN if ...]`."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

from ifgen.definition.meaning.values import Invalid, Meaning, Number, Range

Kind: TypeAlias = Literal["float", "integer", "text", "message", "other"]
"""The values of a field, as far as a meaning depends on them; `other` are booleans, bytes and characters."""

_NAMES: Final = ("unit", "range", "enum", "frame", "invalid", "deprecated")
_NOTE: Final = re.compile(r"\([^()]*\)")
_NUMBER: Final = re.compile(
    r"(?P<sign>[+-]?)\s*(?:(?P<hex>0x[0-9a-f]{1,16})|(?P<infinite>inf(?:inity)?)"
    r"|(?:(?P<factor>\d{1,9}(?:\.\d{0,20})?)\s*\*?\s*)?(?:pi|\u03c0)(?:\s*/\s*(?P<divisor>[1-9]\d{0,8}))?"
    r"|(?P<plain>(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:e[+-]?\d{1,4})?))",
    re.IGNORECASE,
)
_LIMIT: Final = re.compile(r"(?P<unsigned>U?)INT(?P<bits>8|16|32|64)_(?P<end>MAX|MIN)")
_CONSTANT: Final = re.compile(r"[A-Za-z]\w*")


@dataclass(frozen=True, slots=True)
class Mistake:
    """A tag that cannot be read: its text as it stands in the comment, what is wrong, and what to do."""

    tag: str
    message: str
    advice: str


def read_tag(meaning: Meaning, name: str, rest: str, tag: str, kind: Kind) -> Meaning | Mistake | None:
    """Add a tag to a meaning. None if there is no tag of this name, and none with a similar one."""
    match name:
        case "unit":
            return (
                replace(meaning, unit=rest)
                if rest
                else Mistake(tag, "`@unit` names no unit", "write `[m/s]`")
            )
        case "range":
            return _range(meaning, rest, tag, kind)
        case "enum":
            return _enum(meaning, rest, tag, kind)
        case "frame":
            if rest:
                return replace(meaning, frame=rest)
            return Mistake(tag, "`@frame` names no frame", "write `[@frame NED]`")
        case "invalid":
            return _invalid(meaning, rest, tag, kind)
        case "deprecated":
            return replace(meaning, deprecated=rest)
        case _:
            from difflib import get_close_matches  # late: few tags are unknown

            near = get_close_matches(name.lower(), _NAMES, n=1, cutoff=0.75)
            advice = f"did you mean `@{near[0]}`?" if near else ""
            return Mistake(tag, f"there is no tag `@{name}`", advice) if near else None


def unclosed(name: str, tag: str) -> Mistake | None:
    """The mistake of a tag without `]`; None if there is no tag of this name."""
    return Mistake(tag, f"`@{name}` has no closing bracket", "end it with `]`") if name in _NAMES else None


def number(text: str) -> Number | None:
    """A number as people write it: `-1`, `0.5`, `1e3`, `0xFF`, `inf`, `-pi`, `2*pi`; None if it is none."""
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        return None
    sign = -1 if match["sign"] == "-" else 1
    if match["hex"]:
        return sign * int(match["hex"], 16)
    if match["infinite"]:
        return sign * math.inf
    if match["plain"]:
        plain = match["plain"]
        return sign * (int(plain) if plain.isdigit() else float(plain))
    return sign * float(match["factor"] or 1) * math.pi / int(match["divisor"] or 1)


def _range(meaning: Meaning, rest: str, tag: str, kind: Kind) -> Meaning | Mistake:
    if kind in {"text", "other"}:
        return Mistake(tag, "`@range` is for numbers, and this field holds none", "remove it")
    parts = [_NOTE.sub("", part).strip() for part in re.split(r",(?![^()]*\))", rest)]
    if len(parts) != 2:
        return Mistake(tag, "a range has two bounds, with a comma between them", "write `[@range 0, 3]`")
    bounds = [number(part) if part else None for part in parts]
    for part, bound in zip(parts, bounds, strict=True):
        if part and bound is None:
            return Mistake(
                tag, f"`{part[:40]}` is not a number", "write `[@range 0, 3]`, or leave a bound out"
            )
    range_ = Range(*(None if bound is None or math.isinf(bound) else bound for bound in bounds))
    if range_.is_empty:
        return Mistake(tag, f"the range {rest[:40]} is empty", "write the smaller bound first")
    return meaning if range_ == Range() else replace(meaning, range=range_)


def _enum(meaning: Meaning, rest: str, tag: str, kind: Kind) -> Meaning | Mistake:
    names = [name.removesuffix("*").removesuffix("_") for name in re.split(r"[\s,|]+", rest) if name]
    if not names or not all(map(_CONSTANT.fullmatch, names)):
        return Mistake(tag, "`@enum` names no prefix of constants", "write `[@enum MODE]` for `MODE_...`")
    if kind != "integer":
        return Mistake(tag, "`@enum` is for integers, and this field holds none", "remove it")
    return replace(meaning, enum=tuple(dict.fromkeys(names)))


def _invalid(meaning: Meaning, rest: str, tag: str, kind: Kind) -> Meaning | Mistake:
    first, *others = re.split(r"[\s,:]+", rest, maxsplit=1)
    value = math.nan if first.lower() == "nan" else _limit(first) or number(first)
    if value is None:
        return Mistake(tag, "`@invalid` names no value", "write `[@invalid NaN]`, or another number")
    if isinstance(value, float) and not math.isfinite(value) and kind == "integer":
        return Mistake(tag, f"an integer is never {first}", "name a value that the field can hold")
    return replace(meaning, invalid=Invalid(value, "".join(others).strip(" ()")))


def _limit(text: str) -> int | None:
    """The value of a limit as C names it: `UINT16_MAX`."""
    match = _LIMIT.fullmatch(text)
    if match is None:
        return None
    bits = int(match["bits"]) - (not match["unsigned"])
    return 2**bits - 1 if match["end"] == "MAX" else 0 if match["unsigned"] else -(2**bits)
