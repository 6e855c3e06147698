"""Explanations of mistakes in a definition. Called only after a mistake has been found."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from ifgen import diagnostics
from ifgen.definition import rules
from ifgen.definition.literals import BadValue
from ifgen.definition.names import is_constant_name, is_field_name, snake_case
from ifgen.definition.spelling import PRIMITIVES, BadType
from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten

_FOREIGN_TYPES: Final = {
    "int": "`int32` or `int64`",
    "uint": "`uint32` or `uint64`",
    "integer": "`int32` or `int64`",
    "long": "`int64`",
    "short": "`int16`",
    "unsigned": "`uint32`",
    "size_t": "`uint64`",
    "float": "`float32` or `float64`",
    "double": "`float64`",
    "float128": "`float64`, the widest there is",
    "int128": "`int64`, the widest there is",
    "number": "`float64`",
    "str": "`string`",
    "text": "`string`",
    "std::string": "`string`",
    "boolean": "`bool`",
    "bytes": "`uint8[]`",
    "octet": "`byte` or `uint8`",
    "time": "`builtin_interfaces/Time`; ROS 2 has no `time` of its own",
    "duration": "`builtin_interfaces/Duration`; ROS 2 has no `duration` of its own",
}
_FOREIGN_COMMENTS: Final = ("//", "/*", "*", "--", ";", "%")
_LOWER_RULE: Final = (
    "lower-case letters, digits and single underscores, a letter first and no underscore at the end"
)
_UPPER_RULE: Final = (
    "upper-case letters, digits and single underscores, a letter first and no underscore at the end"
)
_SIZE_HELP: Final = "write `T[N]` for exactly N elements, `T[<=N]` for at most N, `T[]` for any number"
_BOUND_HELP: Final = "write `string<=N` for at most N characters, without spaces"


def bad_type(problem: BadType, text: str, source: Source, start: int) -> Diagnostic:
    """Say why the text of a type, which starts at `start`, is no type."""
    span = Span(source, start + problem.start, start + problem.end)
    return Diagnostic(problem.rule, problem.message, Label(span), help=_type_help(problem, text))


def _type_help(problem: BadType, text: str) -> str:
    if text.startswith(_FOREIGN_COMMENTS):
        return "a comment starts with `#`"
    if text.startswith("@"):
        return "remove it: the only annotation here is `@optional`, since ROS 2 Lyrical"
    base = shorten(text.partition("[")[0])
    if problem.rule == "invalid-size":
        return _SIZE_HELP if text.endswith("]") else _BOUND_HELP
    if base in _FOREIGN_TYPES:
        return f"write {_FOREIGN_TYPES[base]}"
    if re.fullmatch(r"\w+::(msg::)?\w+", base):
        return f"write `{base.replace('::msg::', '/').replace('::', '/')}`; `ifgen check --fix` does so"
    if text.count("[") > 1:
        return "arrays have one dimension: make it longer, or define a message for a row"
    if text.endswith("[") or "]" in text or "[" in base:
        return f"{_SIZE_HELP}; no spaces inside the brackets"
    if re.match(r"w?string\W", base):
        return _BOUND_HELP
    package, _, name = base.rpartition("/")
    if package.endswith("/msg"):
        return f"write `{package.removesuffix('/msg')}/{name}`: a field's type is always a message"
    if base.endswith("_Event"):
        return "the event message of a service cannot be the type of a field"
    camel = "".join(word[:1].upper() + word[1:] for word in re.split(r"[_\W]+", name) if word)
    hint = did_you_mean(base, PRIMITIVES)
    if hint is None and camel and camel != name:
        hint = f"did you mean `{package}/{camel}`?" if package else f"did you mean `{camel}`?"
    return hint or "a type is a primitive such as `float64`, `Name` from the same package, or `package/Name`"


def invalid_field_name(name: str, span: Span) -> Diagnostic:
    """Say why a field cannot have this name."""
    shown = shorten(name)
    array = re.fullmatch(r"(\w+)(\[.*\])", shown)
    snake = _joined(snake_case(shown))
    if array:
        help = f"the brackets belong to the type: `TYPE{array[2]} {array[1]}`"
    elif name.startswith("[") and name.endswith("]"):
        help = f"remove the space before the brackets: `TYPE{shown} NAME`"
    elif name.endswith((";", ",")):
        help = f"remove the `{name[-1]}`; a definition ends with its line"
    elif snake != name and is_field_name(snake):
        help = f"did you mean `{snake}`? Field names are {_LOWER_RULE}"
    else:
        help = f"field names are {_LOWER_RULE}"
    return Diagnostic("invalid-field-name", f"`{shown}` is not a valid field name", Label(span), help=help)


def invalid_constant_name(name: str, span: Span) -> Diagnostic:
    """Say why a constant cannot have this name."""
    shown = shorten(name)
    upper = _joined(shown if shown.isupper() else snake_case(shown)).upper()
    if set(name) <= set("<>"):
        help = "write bounds without spaces: `string<=10 name`"
    elif name.startswith("["):
        help = "write bounds without spaces: `TYPE[<=10] NAME`"
    elif upper != name and is_constant_name(upper):
        help = f"did you mean `{upper}`? A line with an `=` is a constant; a default value has none"
    else:
        help = f"constant names are {_UPPER_RULE}"
    return Diagnostic(
        "invalid-constant-name", f"`{shown}` is not a valid constant name", Label(span), help=help
    )


def _joined(text: str) -> str:
    """The words of a text with single underscores between."""
    return "_".join(re.findall(r"[A-Za-z0-9]+", text))


def constant_type(text: str, span: Span) -> Diagnostic:
    """Say that a constant cannot be of a type."""
    base = text.partition("[")[0]
    if base in _FOREIGN_TYPES:
        help = f"write {_FOREIGN_TYPES[base]}"
    elif text.endswith("]"):
        help = "an array cannot be a constant: write one constant for each element"
    elif text.startswith(("string<", "wstring<")):
        help = "write `string`: a constant has no bound"
    else:
        help = did_you_mean(text, PRIMITIVES) or "constants are numbers, booleans and strings"
    return Diagnostic(
        "invalid-constant-type", f"a constant cannot be of type `{shorten(text)}`", Label(span), help=help
    )


def duplicate(what: str, name: str, span: Span, first: Span | None) -> Diagnostic:
    """Say that two fields or two constants of a message have the same name."""
    return Diagnostic(
        f"duplicate-{what}",
        f"{what} '{shorten(name)}' is declared twice",
        Label(span, "declared again"),
        (Label(first, "first declared here"),) if first else (),
        "rename one of them",
    )


def bad_value(error: BadValue, type_text: str | None, span: Span) -> Diagnostic:
    """Explain why a text is not a value of its type, which may be None."""
    text = span.source.text[span.start : span.end]
    of_type = f" of type `{shorten(type_text)}`" if type_text else ""
    message = f"`{shorten(text)}` is not a value{of_type}" if text else "the value is missing"
    help = "a `#` starts a comment, even inside quotes" if rules.is_truncated(text, span) else error.help
    return Diagnostic(error.rule, message, Label(span, error.message), help=help)


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A hint at the known names that look most alike."""
    return diagnostics.did_you_mean(name, known, form="`{}`", limit=3) or None
