"""Explanations of lines that are not definitions. Called only after a line has been refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten

_SEPARATORS: Final = {
    0: "a message has no `---` line",
    1: "a service needs exactly one `---` line",
    2: "an action needs exactly two `---` lines",
}
_SEPARATORS_HELP: Final = {
    0: "a request and a response go into a .srv file; a goal, a result and feedback go into an .action file",
    1: "the `---` line stands between request and response, alone on its line; either may be empty",
    2: "the `---` lines stand between goal, result and feedback, each alone on its line; any may be empty",
}
_ORDINALS: Final = ("first", "second", "third")


def refused_line(source: Source, start: int, end: int) -> Diagnostic:
    """Say what is wrong with a line's text, which is `start` to `end` of a source."""
    written = source.text[start:end]
    words = written.strip()
    indent = len(written) - len(written.lstrip())
    span = Span(source, start + indent, start + indent + len(words))
    if words == "---":
        return Diagnostic(
            "bad-separator",
            "a `---` line must hold nothing else",
            Label(span, "with spaces or a comment it is not a separator"),
            help="remove the spaces and the comment from this line",
        )
    if indent and len(words.split(None, 1)) == 2:
        return Diagnostic(
            "indented-definition",
            "a definition must start in the first column",
            Label(Span(source, start, start + indent), "rosidl fails on this space"),
            help="remove the space in front of the line",
        )
    if set(words) == {"-"}:
        return Diagnostic(
            "bad-separator", f"`{shorten(words)}` is not a separator", Label(span), help="write exactly `---`"
        )
    if words.startswith("//"):
        message = f"`{shorten(words)}` is not a definition"
        return Diagnostic("missing-name", message, Label(span), help="a comment starts with `#`")
    type_text, equals, _ = words.partition("=")
    if equals:
        return Diagnostic(
            "missing-name",
            f"expected a name between the type `{shorten(type_text.strip())}` and the `=`",
            Label(span),
            help="write a constant as `TYPE NAME=VALUE`, for example `uint8 LEFT=1`",
        )
    return Diagnostic(
        "missing-name",
        f"expected a type and a name, found only `{shorten(words)}`",
        Label(span),
        help="write a field as `TYPE NAME`, for example `float64 x`, with plain spaces or tabs between",
    )


def refused_constant(source: Source, start: int, end: int) -> Diagnostic:
    """Say what is wrong with what follows a type where there is more than one word before the `=`."""
    written = source.text[start:end]
    name = written.partition("=")[0]
    start += len(name) - len(name.lstrip())
    name = name.strip()
    span = Span(source, start, start + len(name))
    help = 'a line with an `=` is a constant; a default value has none: `string name "value"`'
    return Diagnostic(
        "invalid-constant-name", f"`{shorten(name)}` cannot be the name of a constant", Label(span), help=help
    )


def second_optional(source: Source, start: int, end: int) -> Diagnostic:
    """Say that there are two annotations for one definition."""
    return Diagnostic(
        "optional-field",
        "this is the second `@optional` of one definition",
        Label(Span(source, start, end)),
        help="remove one of them",
    )


def byte_order_mark(source: Source) -> Diagnostic:
    """Say that a file starts with a byte order mark."""
    return Diagnostic(
        "byte-order-mark",
        "the file starts with a byte order mark",
        Label(Span(source, 0, 1), "the invisible character U+FEFF"),
        help="save the file as UTF-8 without a byte order mark; rosidl refuses it",
    )


def wrong_separators(source: Source, separators: Sequence[Span], expected: int) -> Diagnostic:
    """Say that a file has too many or too few `---` lines."""
    if len(separators) > expected:
        primary = Label(separators[expected], "one too many")
    else:
        end = len(source.text.rstrip("\r\n"))
        primary = Label(Span(source, end, end), "the file ends here")
    secondary = tuple(
        Label(span, f"the {_ORDINALS[number]}") for number, span in enumerate(separators[:expected])
    )
    message = f"{_SEPARATORS[expected]}, found {len(separators)}" if expected else _SEPARATORS[0]
    return Diagnostic("wrong-separators", message, primary, secondary, _SEPARATORS_HELP[expected])


def too_many_definitions(place: Span, limit: int) -> Diagnostic:
    """Say that reading stopped because the file cannot be an interface."""
    return Diagnostic(
        "too-many-definitions",
        f"more than {limit} definitions in one file",
        Label(place, "reading stops here"),
        help="if this is an interface file, divide it into several messages",
    )
