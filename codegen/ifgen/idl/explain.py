"""Why a line cannot be a definition: looked into only once the line has been refused."""

from __future__ import annotations

from collections.abc import Sequence

from ifgen.diagnostics import Diagnostic, Label, Source, Span

_KINDS = {0: "message", 1: "service", 2: "action"}
_PARTS = {1: "request and response", 2: "goal, result and feedback"}


def refused_line(source: Source, start: int, end: int) -> Diagnostic:
    """Say what is wrong with the words from `start` to `end` of a source."""
    words = source.text[start:end]
    stripped = words.strip()
    start += len(words) - len(words.lstrip())
    span = Span(source, start, start + len(stripped))
    if stripped.startswith("\ufeff"):
        return Diagnostic(
            "byte-order-mark",
            "the file starts with a byte order mark",
            Label(Span(source, span.start, span.start + 1), "invisible character U+FEFF"),
            help="save the file as UTF-8 without a byte order mark",
        )
    if stripped == "---":
        return Diagnostic(
            "bad-separator",
            "a separator line must hold `---` and nothing else",
            Label(span),
            help="remove the spaces and the comment from this line",
        )
    if words[0].isspace() and span.column > 1:
        return Diagnostic(
            "indented-definition",
            "a definition must start in the first column",
            Label(span, "indented"),
            help="remove the space before it",
        )
    type_text, _, rest = stripped.partition(" ")
    if "=" in rest or rest.startswith("="):
        return Diagnostic(
            "missing-name",
            "a constant needs a name before the `=`",
            Label(span),
            help="write it as `TYPE NAME=VALUE`, for example `uint8 LEFT=1`",
        )
    return Diagnostic(
        "missing-name",
        f"expected a type and a name, found only {shorten(stripped)!r}",
        Label(span),
        help="write a field as `TYPE NAME`, for example `float64 x`",
    )


def wrong_separators(source: Source, separators: Sequence[Span], expected: int) -> Diagnostic:
    """Say that a file has the wrong number of `---` lines."""
    kind = _KINDS[expected]
    found = len(separators)
    if expected == 0:
        message = "a message has no `---` line"
        advice = (
            "put requests and responses into a .srv file and goals, results and feedback into an .action file"
        )
    else:
        lines = "exactly one `---` line" if expected == 1 else f"exactly {expected} `---` lines"
        message = f"{kind} needs {lines}, found {found}".replace("service", "a service", 1)
        message = message.replace("action", "an action", 1)
        advice = f"the `---` lines divide {_PARTS[expected]}; each stands alone on its line"
    if found > expected:
        primary, secondary = separators[expected], separators[:expected]
        return Diagnostic(
            "wrong-separators",
            message,
            Label(primary, "one too many"),
            tuple(Label(span, "an earlier one") for span in secondary),
            advice,
        )
    end = len(source.text.rstrip("\r\n"))
    return Diagnostic(
        "wrong-separators",
        message,
        Label(Span(source, end, end), "the file ends here"),
        tuple(Label(span, "the only one") for span in separators),
        advice,
    )


def too_many_definitions(place: Span, limit: int) -> Diagnostic:
    """Say that reading stopped because the file cannot be an interface."""
    return Diagnostic(
        "too-many-definitions",
        f"more than {limit} definitions in one file",
        Label(place, "reading stops here"),
        help="is this an interface file?",
    )


def shorten(text: str, limit: int = 60) -> str:
    """The text, cut to what fits into a message."""
    return text if len(text) <= limit else text[: limit - 3] + "..."
