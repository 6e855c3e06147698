"""The arguments of jinja2's filters and tests, and the results of filters."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, Final, get_type_hints

from jinja2.utils import pass_context, pass_environment, pass_eval_context

from ifgen.generator_py.templates.check.types import (
    ANYTHING,
    NUMBER,
    TEXT,
    Group,
    Many,
    Plain,
    Table,
    Type,
    either,
    element_of,
    of_annotation,
    result_of,
)

FOR_TEXT: Final = frozenset(
    (
        *("capitalize", "center", "indent", "lower", "replace", "striptags", "title", "trim"),
        *("truncate", "upper", "urlize", "wordcount", "wordwrap"),
    )
)
"""Filters that want text; of something else they take what Python prints of it."""

ATTRIBUTE_FIRST: Final = frozenset(("groupby", "map", "rejectattr", "selectattr", "sum", "unique"))
ATTRIBUTES: Final = ATTRIBUTE_FIRST | {"join", "max", "min", "sort"}
"""Filters that can get an attribute of the elements, by keyword or as the first argument."""

FOR_MANY: Final = ATTRIBUTES | frozenset(
    ("batch", "first", "last", "length", "count", "list", "random", "reject", "reverse", "select", "slice")
)
"""Filters that want something to loop over."""

_TEXT_RESULTS: Final = FOR_TEXT - {"wordcount"} | frozenset(
    (
        *("e", "escape", "filesizeformat", "forceescape", "format", "join", "pprint", "string"),
        *("tojson", "urlencode", "xmlattr"),
    )
)
_NUMBER_RESULTS: Final = frozenset(("count", "int", "length", "wordcount"))
_ELEMENT_RESULTS: Final = frozenset(("first", "last", "max", "min", "random"))
_SAME_ELEMENTS: Final = frozenset(
    ("list", "reject", "rejectattr", "reverse", "select", "selectattr", "sort", "unique")
)


def result_of_filter(name: str, value: Type, arguments: Sequence[Type]) -> Type:
    """The result of one of jinja2's filters for a value."""
    element = element_of(value)
    element = ANYTHING if element is None else element
    if name in _TEXT_RESULTS:
        return TEXT
    if name in _NUMBER_RESULTS:
        return NUMBER
    if name in _ELEMENT_RESULTS:
        return element
    if name == "reverse" and value == TEXT:
        return TEXT
    if name in _SAME_ELEMENTS:
        return Many(element)
    match name:
        case "batch" | "slice":
            return Many(Many(element))
        case "items" | "dictsort":
            return Many(Group((value.key, value.value))) if isinstance(value, Table) else ANYTHING
        case "default" | "d":
            return either((value, *arguments[:1]))
        case "float":
            return Plain(float)
        case "safe" | "abs":
            return value
        case "map":
            return Many(ANYTHING)
        case _:
            return ANYTHING


def result_of_function(function: Callable[..., Any]) -> Type:
    """The result of one of the user's filters, by its annotation."""
    return of_annotation(result_of(function))


def wanted_by(function: Callable[..., Any]) -> Type:
    """The argument type of one of the user's filters, by its annotation."""
    try:
        hints = getattr(function, "__annotations__", {})
    except NameError:  # from CPython 3.14 on they are worked out here, with names that only a checker imports
        return ANYTHING
    names = [name for name in hints if name != "return"]
    if not names or _passed(function):
        return ANYTHING

    def first() -> None:
        """Has one annotation only: of others the names may be unknown here."""

    first.__annotations__ = {names[0]: hints[names[0]]}
    try:
        found = get_type_hints(first, getattr(function, "__globals__", {}))
    except (NameError, TypeError, SyntaxError, AttributeError):
        return ANYTHING
    return of_annotation(found[names[0]])


def misfit(function: object, given: int, keywords: Sequence[str], *, subject: bool) -> str | None:
    """The reason why a function cannot be called with this number of arguments and these keywords, or None.

    With `subject` what stands before the filter or test is an argument too.
    """
    if hasattr(function, "jinja_async_variant"):  # what wraps it has another signature than it shows
        function = getattr(function, "__wrapped__", function)
    if not callable(function):
        return None
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError, NameError):  # NameError as above
        return None
    before = [None] * (_passed(function) + subject + given)
    try:
        signature.bind(*before, **dict.fromkeys(keywords))
    except TypeError as error:
        return str(error)
    return None


def _passed(function: object) -> int:
    """The number of arguments that jinja2 itself puts before the others: a context or an environment."""
    mark = getattr(function, "jinja_pass_arg", None)
    marks = [
        getattr(f(lambda: None), "jinja_pass_arg", None)
        for f in (pass_context, pass_environment, pass_eval_context)
    ]
    return int(mark is not None and mark in marks)
