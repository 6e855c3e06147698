"""Warnings: what we accept though rosidl refuses it later, mangles it, or makes something surprising of it.

Each function looks at one thing and reports at most one finding; `docs/rosidl-differences.md` has the list.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Sequence
from typing import Final

from ifgen.definition.escapes import carried, interpreted, is_carried
from ifgen.definition.interfaces import Scalar
from ifgen.definition.names import PLACEHOLDER
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    FieldType,
    UnboundedSequence,
    ValueType,
)
from ifgen.diagnostics import Diagnostic, Label, Span, shorten

_C_KEYWORDS: Final = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int
    long register restrict return short signed sizeof static struct switch typedef union unsigned void
    volatile while
    """.split()  # noqa: SIM905  # a list of fifty strings is harder to read
)
_CPP_KEYWORDS: Final = frozenset(
    """
    alignas alignof and and_eq asm bitand bitor bool catch class compl constexpr const_cast decltype
    delete dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr
    operator or or_eq private protected public reinterpret_cast static_assert static_cast template this
    thread_local throw true try typeid typename using virtual wchar_t xor xor_eq
    """.split()  # noqa: SIM905  # a list of fifty strings is harder to read
)
_RESERVED: Final = {
    "check_fields": "in rosidl's class it collides with the constructor's keyword of the same name",
    "get_fields_and_field_types": "in rosidl's class it hides the method of the same name, and repr() fails",
    "self": "rosidl's class does not take it as a keyword: M(self=1) is a TypeError",
    PLACEHOLDER: "rosidl hides this field: it stands for an empty message",
}
_TROUBLESOME: Final = frozenset(keyword.kwlist) | _C_KEYWORDS | _CPP_KEYWORDS | _RESERVED.keys()

_LARGEST_FLOAT32: Final = (2 - 2**-24) * 2.0**127
"""From here on a number is infinite as a float32."""
_LARGEST_SIZE: Final = 2**32 - 1
_COMMENT_FOLLOWS: Final = re.compile(r"[ \t]*#")
_ELEMENT: Final = re.compile(r"""\s*("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'|[^,"'\s](?:[^,"'\\]*))\s*(,|\Z)""")


def is_troublesome(name: str) -> bool:
    """Whether `field_name` has something to say; a name that costs a look-up only."""
    return name in _TROUBLESOME


def field_name(name: str, span: Span) -> Diagnostic:
    """A field name that rosidl's generated code cannot bear."""
    if name in _RESERVED:
        return _warning("reserved-name", f"'{name}' is a troublesome field name", span, _RESERVED[name])
    if keyword.iskeyword(name):
        language = "Python"
        effect = f"rosidl's class cannot be imported; ours calls it `{name}_` and keeps `{name}` on the wire"
    else:
        language = "C" if name in _C_KEYWORDS else "C++"
        effect = f"rosidl's {language} code for it does not compile"
    return _warning("keyword-name", f"'{name}' is a {language} keyword", span, effect)


def check_type(text: str, type_: FieldType, span: Span, problems: FileProblems) -> None:
    """Warn of sizes that no message can have, and of a bound that rosidl puts elsewhere."""
    if isinstance(type_, BoundedSequence) and text.endswith("[]"):
        problems.warning(
            _warning,
            "wstring-sequence",
            f"rosidl takes the bound of `{shorten(text)}` for the sequence's too",
            span,
            f"it reads `{text[:-1]}<={type_.maximum_size}]`, and so do we: write that, or another bound",
        )
    if any(size > _LARGEST_SIZE for size in _sizes(type_)):
        problems.warning(
            _warning,
            "huge-size",
            "a size above 4294967295 cannot be sent",
            span,
            "lengths on the wire have 32 bits",
        )


def _sizes(type_: FieldType) -> list[int]:
    sizes = [getattr(type_, "size", 0), getattr(type_, "maximum_size", 0)]
    if isinstance(type_, Array | BoundedSequence | UnboundedSequence):
        sizes.append(getattr(type_.value_type, "maximum_size", 0))
    return sizes


def check_value(
    text: str, type_: FieldType, value: Scalar | tuple[Scalar, ...], span: Span, problems: FileProblems
) -> None:
    """Warn of a value that is not what its text looks like."""
    values = value if isinstance(value, tuple) else (value,)
    element = _element_type(type_)
    if element == BasicType("float"):
        if any(isinstance(item, float) and abs(item) >= _LARGEST_FLOAT32 for item in values):
            problems.warning(
                _warning,
                "float32-range",
                f"`{shorten(text)}` does not fit into a float32",
                span,
                "rosidl's C code has infinity here; use float64",
            )
    elif not isinstance(element, BasicType):
        _check_string(text, value, span, problems)


def is_truncated(text: str, span: Span) -> bool:
    """Whether a `#` inside the quotes of a value has cut it."""
    return not _is_closed(text) and _COMMENT_FOLLOWS.match(span.source.text, span.end) is not None


def _check_string(text: str, value: Scalar | tuple[Scalar, ...], span: Span, problems: FileProblems) -> None:
    if is_truncated(text, span):
        problems.warning(
            _warning,
            "truncated-string",
            "the `#` inside the quotes starts a comment",
            Span(span.source, span.start, span.source.text.index("#", span.end) + 1),
            f"rosidl reads the value as {_shown(value)}, and so do we; a string cannot hold a `#`",
        )
    elif isinstance(value, tuple):
        if _looks_like(text) != value:
            problems.warning(
                _warning,
                "surprising-strings",
                f"rosidl reads this array as {_shown(value)}",
                span,
                "put commas between elements, no spaces at their ends, and at most one escaped quote in each",
            )
    elif not _is_closed(text):
        problems.warning(
            _warning,
            "stray-quote",
            f"the quotes are part of the value: rosidl reads {_shown(value)}",
            span,
            "quotes count only where both ends of the value have the same one",
        )
    elif "\\" in text and not _is_as_written(text, str(value)):
        problems.warning(
            _warning,
            "double-escape",
            f"rosidl interprets backslashes twice and reads {_shown(value)}",
            span,
            "write four backslashes for one",
        )


def check_unit(unit: str, comments: Sequence[str], span: Span, problems: FileProblems) -> None:
    """Warn of a bracket that was not meant to be a unit."""
    if unit.strip().isdigit() or any(_is_index(line, unit) for line in comments):
        problems.warning(
            _warning,
            "unlikely-unit",
            f"rosidl takes `[{shorten(unit)}]` in the comment for the unit of this field",
            span,
            "write it without brackets, or name the unit in brackets as well: two brackets are no unit",
        )


def _is_index(comment: str, unit: str) -> bool:
    before, bracket, _ = comment.partition(f"[{unit}]")
    return bool(bracket) and before[-1:].isalnum()


def check_comment(text: str, unit: str | None, span: Span, problems: FileProblems) -> None:
    """Warn of a comment that rosidl cannot write into an .idl file, or changes."""
    lines = [*text.split("\n"), unit or ""]
    if not all(map(is_carried, lines)):
        effect = "rosidl_adapter or rosidl_parser fails on it"
    elif any(carried(line) != line for line in lines):
        effect = "rosidl changes it: it interprets the escapes"
    else:
        return
    problems.warning(
        _warning,
        "backslash-in-comment",
        "the comment of this definition has a backslash",
        span,
        f"{effect}; write it without",
    )


def check_unit_lines(span: Span, problems: FileProblems) -> None:
    """Warn of a bracket that spans lines of a comment; called where there is one."""
    problems.warning(
        _warning,
        "bracket-over-lines",
        "a bracket in the comment of this definition goes over several lines",
        span,
        "rosidl takes it for a unit, and rosidl_parser fails on the line break in it",
    )


def _element_type(type_: FieldType) -> ValueType:
    return type_.value_type if isinstance(type_, Array | BoundedSequence | UnboundedSequence) else type_


def _is_closed(text: str) -> bool:
    """Whether a text has a quote at both ends or at none, and so for the brackets of an array."""
    first, last = text[:1], text[-1:]
    if first == "[":
        return last == "]"
    if first in {'"', "'"}:
        return first == last and len(text) > 1
    return last not in {'"', "'"}


def _is_as_written(text: str, value: str) -> bool:
    """Whether a value is what its text says to who interprets escapes once, or knows of the second time."""
    quote = text[0] if text[0] in "\"'" else None
    inside = text[1:-1].replace("\\" + quote, quote) if quote else text
    return inside == value.replace("\\", "\\" * 4) or interpreted(inside) == value


def _looks_like(text: str) -> tuple[str | None, ...] | None:
    """The array that a text looks like to who knows how strings are quoted; None if it looks broken."""
    inside = text[1:-1]
    elements: list[str | None] = []
    position = 0
    more = bool(inside)
    while more:
        match = _ELEMENT.match(inside, position)
        if match is None:
            return None
        written = match[1]
        elements.append(interpreted(written[1:-1]) if written[0] in "\"'" else written.rstrip())
        position = match.end()
        more = match[2] == ","
    return tuple(elements)


def _shown(value: Scalar | tuple[Scalar, ...]) -> str:
    shown = f"[{', '.join(map(repr, value))}]" if isinstance(value, tuple) else repr(value)
    return shorten(shown)


def _warning(rule: str, message: str, span: Span, help: str) -> Diagnostic:
    return Diagnostic(rule, message, Label(span), help=help, severity="warning")
