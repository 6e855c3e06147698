"""Warnings: what we accept though rosidl refuses it later, mangles it, or makes something surprising of it.

Each function looks at one thing and reports at most one finding; `docs/rosidl-differences.md` has the list.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Sequence
from typing import Final

from ifgen.definition.interfaces import Constant, Message, Scalar
from ifgen.definition.literals import carried, interpreted, is_carried
from ifgen.definition.names import PLACEHOLDER
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import (
    BasicType,
    BoundedSequence,
    FieldType,
    element_of,
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
    PLACEHOLDER: "rosidl hides a field of this name: it stands for an empty message",
}
_TROUBLESOME: Final = frozenset(keyword.kwlist) | _C_KEYWORDS | _CPP_KEYWORDS | _RESERVED.keys()

_LARGEST_FLOAT32: Final = (2 - 2**-24) * 2.0**127
"""From here on a number is infinite as a float32."""
_READABLE: Final = 10_000
"""The length in characters of an array after which the quotes of its strings are not checked."""
_LAST_WORD: Final = re.compile(r"\w+\Z")
_COMMENT_FOLLOWS: Final = re.compile(r"[ \t]*#")
_ELEMENT: Final = re.compile(r"""\s*("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'|[^,"'\s](?:[^,"'\\]*))\s*(,|\Z)""")


def is_troublesome(name: str) -> bool:
    """Whether `field_name` has something to say; a name that costs a look-up only."""
    return name in _TROUBLESOME


def field_name(name: str, span: Span) -> Diagnostic:
    """A field name that rosidl's generated code cannot bear."""
    if name in _RESERVED:
        return _warning("reserved-name", f"a field should not be called '{name}'", span, _RESERVED[name])
    advice = "rename the field to use the interface with rosidl"
    if keyword.iskeyword(name):
        language, effect = "Python", "rosidl's Python class cannot be imported"
        advice = f"in our class it is `{name}_`, on the wire `{name}`; {advice}"
    else:
        language = "C" if name in _C_KEYWORDS else "C++"
        effect = f"rosidl's {language} code for it does not compile"
    return _warning("keyword-name", f"the field name '{name}' is a {language} keyword", span, effect, advice)


def optional_field(span: Span) -> Diagnostic:
    """An annotation that rosidl reads since Lyrical, and that none of its generators acts on."""
    return _warning(
        "optional-field",
        "`@optional` has no effect yet",
        span,
        "rosidl reads it since ROS 2 Lyrical, and generates an ordinary field",
        "ROS 2 before Lyrical refuses the file; ours is an ordinary field too",
    )


def check_type(text: str, type_: FieldType, span: Span, problems: FileProblems) -> None:
    """Warn of a bound that rosidl puts elsewhere, in a .msg file."""
    if isinstance(type_, BoundedSequence) and text.endswith("[]"):
        problems.warning(
            _warning,
            "wstring-sequence",
            f"rosidl applies the bound of `{shorten(text)}` to the sequence, too",
            span,
            f"rosidl reads `{text[:-1]}<={type_.maximum_size}]`, and so do we",
            "write that, or give the sequence its own bound",
        )


def check_value(
    text: str, type_: FieldType, value: Scalar | tuple[Scalar, ...], span: Span, problems: FileProblems
) -> None:
    """Warn of a value that is not what its text looks like."""
    if isinstance(element_of(type_), BasicType):
        check_float32(type_, value, span, problems)
    else:
        _check_string(text, value, span, problems)


def check_float32(
    type_: FieldType,
    value: Scalar | tuple[Scalar, ...],
    span: Span,
    problems: FileProblems,
    wider: str = "float64",
) -> None:
    """Warn of a number that is too large for its type; `wider` is what the file calls the wider one."""
    values = value if isinstance(value, tuple) else (value,)
    if element_of(type_) == BasicType("float") and any(
        isinstance(item, float) and abs(item) >= _LARGEST_FLOAT32 for item in values
    ):
        problems.warning(
            _warning,
            "float32-range",
            f"`{shorten(span.source.text[span.start : span.end])}` does not fit into a float32",
            span,
            "rosidl's C code has infinity here",
            f"make it a {wider}",
        )


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
            f"rosidl reads the value {_shown(value)}, and so do we",
            "a string in an interface cannot hold a `#`",
        )
    elif isinstance(value, tuple):
        if len(text) < _READABLE and _looks_like(text) != value:
            problems.warning(
                _warning,
                "surprising-strings",
                "this array of strings does not mean what it seems to",
                span,
                f"rosidl reads {_shown(value)}, and so do we",
                "put commas between elements, no spaces at their ends, and at most one escaped quote in each",
            )
    elif not _is_closed(text):
        problems.warning(
            _warning,
            "stray-quote",
            "the quotes are part of the value",
            span,
            f"rosidl reads {_shown(value)}, and so do we",
            "quotes count only if both ends of the value have the same one",
        )
    elif "\\" in text and not _is_as_written(text, str(value)):
        problems.warning(
            _warning,
            "double-escape",
            "backslashes are interpreted twice",
            span,
            f"rosidl reads {_shown(value)}, and so do we",
            "write four backslashes for one",
        )


def check_unit(unit: str, comments: Sequence[str], span: Span, problems: FileProblems) -> None:
    """Warn of a bracket that was not meant to be a unit."""
    if unit.strip().isdigit() or any(_is_index(line, unit) for line in comments):
        problems.warning(
            _warning,
            "unlikely-unit",
            f"`[{shorten(unit)}]` in the comment counts as the unit of this field",
            span,
            f"rosidl takes the only bracket of a comment for a unit: `{shorten(unit)}`",
            "write it without brackets, or name the unit in brackets too: two brackets are not a unit",
        )


def _is_index(comment: str, unit: str) -> bool:
    before, bracket, _ = comment.partition(f"[{unit}]")
    if not bracket or not before[-1:].isalnum():
        return False
    from ifgen.definition.meaning.units import is_unit  # late: few brackets stand at the end of a word

    word = _LAST_WORD.search(before)
    is_name = word is None or len(word[0]) < 3 or not word[0].isalpha()  # `c[m]`, not `depth[m]`
    return not is_unit(unit) or (len(unit) == 1 and is_name)


def check_comment(text: str, unit: str | None, span: Span, problems: FileProblems) -> None:
    """Warn of lines of a comment that rosidl cannot write into an .idl file, or changes."""
    for line in (*text.split("\n"), unit or ""):
        if "\\" in line and not (is_carried(line) and carried(line) == line):
            problems.warning(_backslash, line, span)


def _backslash(line: str, definition: Span) -> Diagnostic:
    source = definition.source
    start = source.text.find(line)
    span = Span(source, start, start + len(line)) if start >= 0 else definition
    if is_carried(line):
        effect = f"rosidl interprets it and reads {_shown(carried(line))}"
    else:
        effect = "rosidl fails on it, in rosidl_adapter or rosidl_parser"
    return _warning("backslash-in-comment", "a backslash in a comment", span, effect, "write it without")


def bracket_over_lines(span: Span) -> Diagnostic:
    """A bracket in the comment of a field that opens on one line and closes on another."""
    return _warning(
        "bracket-over-lines",
        "a bracket in the comment of this field spans several lines",
        span,
        "rosidl takes it for a unit, and rosidl_parser fails on the line break in it",
        "close the bracket on its line, or leave it out",
    )


def check_constants(messages: Sequence[Message], problems: FileProblems) -> None:
    """Warn of constants that two parts of a service or an action share in every respect."""
    known: dict[str, list[Constant]] = {}
    for message in messages:
        for constant in message.constants:
            for other in known.setdefault(constant.name, []):
                if _same_in_idl(constant, other):
                    problems.warning(_same_constant, constant, other)
                    break
            known[constant.name].append(constant)


def _same_in_idl(one: Constant, other: Constant) -> bool:
    return (one.type, one.value, one.documentation) == (other.type, other.value, other.documentation)


def _same_constant(constant: Constant, first: Constant) -> Diagnostic:
    assert constant.span is not None
    return Diagnostic(
        "same-constant",
        f"two parts have the same constant '{constant.name}'",
        Label(
            constant.span, "rosidl_parser assigns this one to the first part, and the C code does not compile"
        ),
        (Label(first.span, "the first"),) if first.span else (),
        "give one of the two another comment: then rosidl keeps them apart",
        "warning",
    )


def _is_closed(text: str) -> bool:
    """Whether a text has a quote at both ends or at none, and so for the brackets of an array."""
    first, last = text[:1], text[-1:]
    if first == "[":
        return last == "]"
    if first in {'"', "'"}:
        return first == last and len(text) > 1
    return last not in {'"', "'"}


def _is_as_written(text: str, value: str) -> bool:
    """True if the value is what the author meant: escapes read once, or each backslash written four times."""
    quote = text[0] if text[0] in "\"'" else None
    inside = text[1:-1].replace("\\" + quote, quote) if quote else text
    return inside == value.replace("\\", "\\" * 4) or interpreted(inside) == value


def _looks_like(text: str) -> tuple[str | None, ...] | None:
    """The array that a reader sees who knows how strings are quoted; None if it looks broken."""
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


def _warning(rule: str, message: str, span: Span, effect: str, advice: str | None = None) -> Diagnostic:
    return Diagnostic(rule, message, Label(span, effect), help=advice, severity="warning")
