"""Reads the meaning of fields from their comments and annotations.

People write it in three ways, and this reads all of them: PX4's standard (`[m/s] [@range 0, 3]`), the habits
of ROS (`# [rad]`, `in meters`, `unit: m/s`, `NaN if unknown`), and annotations of .idl files. None of it is
part of the type: neither the wire nor type descriptions nor hashes depend on it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from ifgen.definition.interfaces import Annotation, Constant, Field, Message
from ifgen.definition.meaning.units import NO_UNIT, is_unit, normal
from ifgen.definition.meaning.values import NOTHING, Invalid, Meaning, Range
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
    UnboundedSequence,
    element_of,
)

if TYPE_CHECKING:
    from ifgen.definition.meaning.tags import Kind, Mistake


@dataclass(frozen=True, slots=True)
class Reading:
    """A comment without its tags, their meaning, and the tags that cannot be read."""

    text: str
    meaning: Meaning = NOTHING
    mistakes: tuple[Mistake, ...] = ()


_TAG: Final = re.compile(r"\[[ \t]*@(?P<name>\w+)(?![\w/])(?P<rest>[^\[\]\n]*)\][ \t]?")
_UNCLOSED: Final = re.compile(r"\[[ \t]*@(?P<name>\w+)(?![\w/])[^\[\]\n]*(?=$|\[)", re.MULTILINE)
_UNIT: Final = re.compile(r"(?<!\S)\[(?P<unit>[^\[\]@\n]{1,40})\][ \t]?")
_NO_UNITS: Final = re.compile(
    r"[-+\d\s.,:]*[\d.,:][-+\d\s.,:]*|bool(ean)?|norm(alized|alised)?|enum\b.*|str(ing)?", re.IGNORECASE
)
_SAID: Final = re.compile(
    r"\bunits?(?::|=| is| are| in)+ ?(?P<unit>[^\s,;:]+(?: per [a-z]+)?)", re.IGNORECASE
)
_IN: Final = re.compile(
    r"\bin (?P<unit>deg(?:rees?)? (?:celsius|fahrenheit|c\b)|[a-z]+ per [a-z]+(?: squared)?"
    r"|[a-z%\u00b0\u00b5\u03a9(][\w%\u00b0\u00b2\u00b3/*^().-]*)(?! (?:and|or) )",
    re.IGNORECASE,
)
_IN_BRACKETS: Final = re.compile(r"(?<!\S)\((?:in )?(?P<unit>[^()\s][^()]{0,30})\)(?=[\s,.;:]|$)")
_SHORT: Final = frozenset(
    """
    m s V A N W K Hz Ah cm mm km kg ms us ns mV mA deg rad min rpm
    """.split()  # noqa: SIM905  # a list of thirty strings is harder to read
)
"""The units of one to three letters that prose means; other such words are as often something else."""
_NO_DATA: Final = re.compile(
    r"(?P<first>\bnan|(?<![\w.-])-?\d+)(?= if (?:not\b|no\b|un\w+|invalid\b|n/a|missing\b))"
    r"|\bif (?:unmeasured|unknown|invalid|unavailable|not \w+),? (?:set to |use )?(?P<last>nan)\b",
    re.IGNORECASE,
)
_DEPRECATED: Final = re.compile(
    r"^[ \t]*(?:@deprecated\b"
    r"|deprecated\b(?=[ \t]*(?:[:.,;!-]|$)|[ \t]+(?:as of|since|in favou?r|use|please)\b))"
    r"[ \t:.,;!-]*(?P<advice>[^\n]*)$"
    r"|\[\[deprecated(?:\([\"']?(?P<quoted>[^()\"'\n]*)[\"']?\))?\]\]",
    re.IGNORECASE | re.MULTILINE,
)
_FLAGS: Final = re.compile(r"\bbit|\bflags?\b|\bmask", re.IGNORECASE)
_HINT: Final = re.compile(r"[\[(@%]|\bin\b|\bunits?\b|\bnan\b|\bif\b|deprecated", re.IGNORECASE)


def meaning_of(described: Field | Constant) -> Meaning:
    """The meaning of a field or a constant; `NOTHING` if neither its comment nor annotations say any."""
    return reading_of(described).meaning


def reading_of(described: Field | Constant) -> Reading:
    """The comment of a field or a constant without its tags, and their meaning."""
    if described.unit is None and not described.annotations and not _HINT.search(described.documentation):
        return Reading(described.documentation)
    kind = _kind(described)
    found = _read(described.documentation, described.unit, kind, _has_one_unit(described))
    return _annotated(found, described.annotations, kind) if described.annotations else found


def deprecation_of(message: Message) -> str | None:
    """The advice of a message that is deprecated, empty without one; None for others."""
    for annotation in message.annotations:
        if annotation.name == "deprecated":
            return _advice(annotation)
    match = _DEPRECATED.match(message.documentation) if message.documentation else None
    return _deprecation(match) if match else None


def named_constants(field: Field, message: Message) -> tuple[Constant, ...]:
    """The constants that `[@enum NAME]` of a field names, in the order of the definition."""
    prefixes = tuple(f"{name}_" for name in meaning_of(field).enum)
    return tuple(each for each in message.constants if prefixes and each.name.startswith(prefixes))


def is_closed(field: Field) -> bool:
    """Whether the constants of `[@enum NAME]` are all the values of a field, and no set of flags."""
    return bool(meaning_of(field).enum) and not _FLAGS.search(field.documentation)


def mistakes_of(field: Field, constants: Iterable[str]) -> Iterator[Mistake]:
    """The tags of a field that cannot be read, or that name none of the constants of its message."""
    from ifgen.definition.meaning.tags import Mistake  # late: few comments have tags

    found = reading_of(field)
    yield from found.mistakes
    names = tuple(constants)
    for prefix in found.meaning.enum:
        if not any(name.startswith(f"{prefix}_") for name in names):
            message = f"no constant of this message begins with `{prefix}_`"
            yield Mistake(prefix, message, "name the prefix of its constants, without the last `_`")


def _kind(described: Field | Constant) -> Kind:
    match element_of(described.type):
        case NamespacedType():
            return "message"
        case BasicType("float" | "double"):
            return "float"
        case BasicType("boolean" | "char" | "octet"):
            return "other"
        case BasicType():
            return "integer"
        case _:
            return "text"


def _has_one_unit(described: Field | Constant) -> bool:
    """Whether a sentence about the field can only be about one number, or several of one kind.

    The elements of a matrix and the fields of a message may have different units.
    """
    match described.type:
        case NamespacedType(package, _, _):
            return package == "geometry_msgs"
        case Array():
            return False
        case BoundedSequence(NamespacedType()) | UnboundedSequence(NamespacedType()):
            return False
        case _:
            return _kind(described) in {"float", "integer"}


@lru_cache(maxsize=1024)
def _read(documentation: str, unit: str | None, kind: Kind, reads_prose: bool) -> Reading:
    """Read a comment. `unit` is its only bracket, which rosidl takes out of the text, if it has one."""
    return _CommentReader(documentation, kind).read(unit, reads_prose=reads_prose)


class _CommentReader:
    """Reads one comment: takes what it understands out of the text."""

    def __init__(self, documentation: str, kind: Kind) -> None:
        self._text = documentation
        self._kind: Kind = kind
        self._meaning = NOTHING
        self._mistakes: list[Mistake] = []
        self._tags: set[str] = set()

    def read(self, bracket: str | None, *, reads_prose: bool) -> Reading:
        """The rest of the text, and the meaning."""
        if "@" in self._text:
            self._text = _TAG.sub(self._tag, self._text)
            from ifgen.definition.meaning.tags import unclosed  # late: few comments have tags

            for match in _UNCLOSED.finditer(self._text):
                mistake = unclosed(match["name"], match[0].rstrip())
                self._mistakes += [mistake] if mistake else []
        if bracket is not None:
            self._only_bracket(bracket)
        self._text = _DEPRECATED.sub(self._deprecated, self._text, count=1)
        if bracket is None and "[" in self._text:
            self._text = _UNIT.sub(self._unit, self._text)
        if reads_prose:
            self._prose()
        text = "\n".join(line.rstrip() for line in self._text.split("\n")).strip("\n")
        return Reading(text.strip(" "), self._meaning, tuple(self._mistakes))

    def _only_bracket(self, content: str) -> None:
        tag = _TAG.fullmatch(f"[{content}]")
        if tag is not None:
            self._text = f"{self._tag(tag)} {self._text}".lstrip()
        elif content.lower().startswith("[deprecated"):  # rosidl takes a half of `[[deprecated]]`
            self._text = self._text.replace("]", f"[{content}]]", 1)
        elif content.strip() == NO_UNIT or self._is_unit(content.strip()):
            self._meaning = replace(self._meaning, unit=content.strip())
        else:
            self._text = f"{self._text} [{content}]".lstrip()

    def _is_unit(self, content: str) -> bool:
        """Whether the only bracket is a unit: rosidl says so of each, `[0-9]` and `[bool]` too."""
        if _NO_UNITS.fullmatch(content) or "@" in content:
            return False
        is_for_numbers = self._kind not in {"text", "other"}
        return normal(content) is not None or (is_for_numbers and len(content) > 2) or is_unit(content)

    def _tag(self, match: re.Match[str]) -> str:
        from ifgen.definition.meaning.tags import Mistake, read_tag  # late: few comments have tags

        name, tag = match["name"], match[0].rstrip()
        if name in self._tags:
            self._mistakes.append(Mistake(tag, f"there are two `@{name}`", "remove one of them"))
            return ""
        found = read_tag(self._meaning, name, match["rest"].strip(), tag, self._kind)
        if found is None:
            return match[0]
        self._tags.add(name)
        if isinstance(found, Mistake):
            self._mistakes.append(found)
            return match[0]
        self._meaning = found
        return ""

    def _deprecated(self, match: re.Match[str]) -> str:
        self._meaning = replace(self._meaning, deprecated=_deprecation(match))
        return ""

    def _unit(self, match: re.Match[str]) -> str:
        """Take a bracket for the unit if it stands at either end of its line and is one."""
        unit = match["unit"].strip()
        before, after = self._text[: match.start()], self._text[match.end() :]
        is_outside = not before.rpartition("\n")[2].strip() or not after.partition("\n")[0].strip(" .;")
        if self._meaning.unit is None and is_outside and normal(unit) is not None:
            self._meaning = replace(self._meaning, unit=unit)
            return ""
        return match[0]

    def _prose(self) -> None:
        """Read units and invalid values that stand in sentences, if there is one of them only."""
        if self._meaning.unit is None:
            units = {_spelled(match["unit"]) for match in _SAID.finditer(self._text)}
            units |= {_spelled(match["unit"]) for match in _IN.finditer(self._text)}
            units |= {_spelled(match["unit"]) for match in _IN_BRACKETS.finditer(self._text)}
            units.discard("")
            if len({normal(unit) for unit in units}) == 1:
                self._meaning = replace(self._meaning, unit=min(units))
        if self._meaning.invalid is None and self._kind != "message":
            values = {match["first"] or match["last"] for match in _NO_DATA.finditer(self._text)}
            if len(values) == 1 and (value := _no_data(values.pop(), self._kind)) is not None:
                self._meaning = replace(self._meaning, invalid=Invalid(value))


def _deprecation(match: re.Match[str]) -> str:
    return (match["quoted"] or match["advice"] or "").strip()


def _spelled(text: str) -> str:
    """The unit that a word of prose is; empty if it is none, or as often something else."""
    unit = text.rstrip(".").removesuffix(")") if "(" not in text else text.rstrip(".")
    if normal(unit) is None or unit == NO_UNIT or unit.isdigit():
        return ""
    return unit if unit in _SHORT or len(unit) > 3 or not unit.isalpha() else ""


def _no_data(text: str, kind: Kind) -> float | int | None:
    if text.lower() == "nan":
        return math.nan if kind == "float" else None
    return int(text)


def _annotated(found: Reading, annotations: Sequence[Annotation], kind: Kind) -> Reading:
    """Add the annotations of an .idl file, which say more than comments."""
    from ifgen.definition.meaning.tags import Mistake  # late: few fields have annotations

    meaning, mistakes = found.meaning, list(found.mistakes)
    for annotation in annotations:
        values = dict(annotation.parameters)
        one = values.get("value", annotation.value)
        match annotation.name:
            case "range" if kind in {"float", "integer", "message"}:
                bounds = Range(_bound(values.get("min")), _bound(values.get("max")))
                if bounds == Range() or bounds.is_empty:
                    advice = "write `@range (min=0, max=3)`"
                    mistakes.append(Mistake("@range", "no number is in this range", advice))
                else:
                    meaning = replace(meaning, range=bounds)
            case "min" if (bound := _bound(one)) is not None:
                meaning = replace(meaning, range=replace(meaning.range or Range(), minimum=bound))
            case "max" if (bound := _bound(one)) is not None:
                meaning = replace(meaning, range=replace(meaning.range or Range(), maximum=bound))
            case "deprecated":
                meaning = replace(meaning, deprecated=_advice(annotation))
            case _:
                pass
    return Reading(found.text, meaning, tuple(mistakes))


def _bound(value: object) -> float | int | None:
    """A bound of a range; None if it is none, or infinite."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return value if math.isfinite(value) else None


def _advice(annotation: Annotation) -> str:
    values = dict(annotation.parameters)
    said = next(iter(values.values()), annotation.value)
    return said if isinstance(said, str) else ""
