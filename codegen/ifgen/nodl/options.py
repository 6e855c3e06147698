"""The contents of `codegen.ifgen` in a document, checked by a pydantic model, and their effect on a node."""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Iterator, Set
from dataclasses import replace
from typing import Any, Final, Literal, TypeAlias, cast

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.config import JsonDict

from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl.model import (
    ClockName,
    Frames,
    MismatchPolicy,
    NodeDescription,
    Parameter,
    Style,
    Terms,
    Timer,
    Validator,
)
from ifgen.nodl.syntax.tree import (
    Key,
    ListNode,
    MapNode,
    Node,
    ScalarNode,
    missing_key,
    plain_value,
    unknown_choice,
    unknown_key,
    wrong_value,
)
from ifgen.nodl.validators import is_custom

Location: TypeAlias = tuple[int | str, ...]
"""The path of a value below `codegen.ifgen`: keys of maps and indexes of lists."""

TestGroup = Literal[
    "contract", "parameters", "topics", "services", "actions", "rates", "action_cancel", "determinism"
]
# To ask for a part of a group, ask for the group.
_GROUPS: Final = {"action_cancel": "actions", "determinism": "rates"}


# The constraints that the code below checks, in terms of JSON schema.
_PYTHON_NAME: Final[JsonDict] = {
    "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
    "patternErrorMessage": "This must be a name in Python.",
}
_MODULE: Final[JsonDict] = {
    "pattern": r"^[A-Za-z_][A-Za-z0-9_]*\.py$",
    "patternErrorMessage": "This must be the file of a Python module, without a folder.",
}
_POSITIVE: Final[JsonDict] = {"exclusiveMinimum": 0}
VERSION: Final = r"^([0-9]+(\.[0-9]+){0,2}(\.\.[0-9]+)?)?$"
"""Versions of interfaces, and ranges of them."""
_PERIODS: Final = ("period", "rate", "period_param")
_ONE_PERIOD: Final[JsonDict] = {
    "oneOf": [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in _PERIODS]
}


class TimerOptions(BaseModel):
    """A timer: exactly one of `period` [s], `rate` [Hz] and `period_param` (a double parameter [s])."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, json_schema_extra=_ONE_PERIOD)

    name: str = Field(description="As in on_NAME_timer.", json_schema_extra=_PYTHON_NAME)
    period: float | None = Field(default=None, description="Seconds.", json_schema_extra=_POSITIVE)
    rate: float | None = Field(default=None, description="Times per second.", json_schema_extra=_POSITIVE)
    period_param: str | None = Field(default=None, description="A double parameter, in seconds.")
    clock: ClockName = Field(default="ros", description="The clock of the timer.")
    publishes: list[str] = Field(default=[], description="Publishers that it sends at this rate.")


class StructOptions(BaseModel):
    """A map of structs: the parameters `of` each, for `each` name."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    each: list[str] | str = Field(
        description="The names, or the parameter (a string_array) whose default has them."
    )
    of: dict[str, dict[str, Any]] = Field(description="The parameters of each, as under `parameters`.")


class EndpointOptions(BaseModel):
    """The terms of an endpoint: what a node promises or needs beyond its type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    required: bool = Field(default=False, description="Somebody must be at the other side.")
    exclusive: bool = Field(default=False, description="Nobody else may publish.")
    rate: float | None = Field(
        default=None, description="Messages per second: sent, or needed.", json_schema_extra=_POSITIVE
    )
    unit: str = Field(default="", description="The unit of the data, such as rad.")
    frame: str = Field(default="", description="The coordinate frame of the data.")
    version: str = Field(
        default="",
        description="Of what is provided, 2.1.0; of what is needed, 2.1 or a range 2.1..3.",
        json_schema_extra={"pattern": VERSION},
    )


class FrameOptions(BaseModel):
    """Coordinate frames: child to parent of those that the node broadcasts, and those that it asks for."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    broadcasts: dict[str, str] = Field(default={}, description="The parent of each frame that it broadcasts.")
    uses: list[str] = Field(default=[], description="Frames that it asks for.")


class Options(BaseModel):
    """The keys below `codegen.ifgen`."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    style: Style = Field(
        default="callbacks", description="The style of the node: what its class derives from."
    )
    node_class: str | None = Field(
        default=None, description="The class of the node.", json_schema_extra=_PYTHON_NAME
    )
    business_file: str | None = Field(
        default=None, description="Your module: a file name.", json_schema_extra=_MODULE
    )
    on_type_mismatch: MismatchPolicy | None = Field(
        default=None, description="What the node does if another one has another definition of a type."
    )
    timers: list[TimerOptions] = Field(default=[], description="The timers of the node.")
    structs: dict[str, StructOptions] = Field(
        default={}, description="Maps of structs, which become parameters GROUP.NAME.FIELD."
    )
    validators: dict[str, str] = Field(
        default={}, description="For each custom validator (ns::name) the dotted path of a Python function."
    )
    endpoints: dict[str, EndpointOptions] = Field(
        default={}, description="Terms of endpoints, by their names as written."
    )
    frames: FrameOptions = Field(default=FrameOptions(), description="Coordinate frames of the node.")
    tests: list[TestGroup] | None = Field(
        default=None, description="Groups of tests to generate; all by default."
    )


_INNER: Final = {
    "endpoints": "the terms of an endpoint",
    "frames": "the frames of a node",
    "structs": "a map of structs",
    "timers": "a timer",
}
_MODELS: Final[dict[str, type[BaseModel]]] = {
    "a map of structs": StructOptions,
    "a timer": TimerOptions,
    "the frames of a node": FrameOptions,
    "the terms of an endpoint": EndpointOptions,
}
_EXPECTED: Final = {
    "bool_type": "true or false",
    "string_type": "a text",
    "float_type": "a number",
    "list_type": "a list",
    "dict_type": "a map",
    "model_type": "a map",
}


def applied(node: NodeDescription, tree: MapNode, problems: FileProblems) -> NodeDescription:
    """The node as `codegen.ifgen` wants it; what is wrong with that is in `problems`.

    What is left of a timer with a mistake is checked too.
    """
    wrong: set[Location] = set()
    try:
        options = Options.model_validate(plain_value(tree))
    except ValidationError as error:
        for details in error.errors(include_url=False):
            problems.error(_diagnostic, tree, cast("dict[str, Any]", details))
            wrong.add(details["loc"])
        if any(location[0] == "structs" for location in wrong):
            wrong.add(("structs",))  # they have been expanded, as far as they can be
        options = Options.model_validate(_without(tree, wrong))
    if options.node_class is not None and not _is_identifier(options.node_class):
        problems.error(_no_identifier, _place(tree, "node_class"), "node_class", options.node_class)
    file = options.business_file
    if file is not None and not (file.endswith(".py") and _is_identifier(file.removesuffix(".py"))):
        problems.error(_no_module, _place(tree, "business_file"), file)
    for validator, function in options.validators.items():
        if not all(map(_is_identifier, function.split("."))) or "." not in function:
            problems.error(_no_function, _place(tree, "validators", validator), function)
    return replace(
        node,
        style=_style(options, node, tree, problems),
        node_class=options.node_class or node.node_class,
        business_file=file or node.business_file,
        on_type_mismatch=options.on_type_mismatch,
        parameters=tuple(_with_functions(parameter, options.validators) for parameter in node.parameters),
        timers=tuple(_timers(options, tree, wrong, problems)),
        terms=tuple(_terms(options, tree, problems)),
        frames=Frames(
            tuple(options.frames.broadcasts.items()), tuple(options.frames.uses), _place(tree, "frames")
        ),
        tests=None
        if options.tests is None
        else tuple(dict.fromkeys(_GROUPS.get(group, group) for group in options.tests)),
    )


def _style(options: Options, node: NodeDescription, tree: MapNode, problems: FileProblems) -> Style:
    """The style that is asked for, else the one that the base class has."""
    if tree.get("style") is None:
        return node.style
    if node.base and node.base.is_lifecycle and options.style in {"callbacks", "asyncio"}:
        problems.error(_no_style_of_base, _place(tree, "style"), options.style, node.base.name)
    return options.style


def _without(node: Node, wrong: Set[Location], at: Location = ()) -> object:
    """A node as plain Python without what is at these locations; a timer that has no name gets one."""
    match node:
        case MapNode(entries):
            kept = {
                key.name: _without(value, wrong, (*at, key.name))
                for key, value in entries
                if (*at, key.name) not in wrong
            }
            if at[:1] == ("timers",) and (*at, "name") in wrong:
                kept["name"] = f"timers[{at[-1]}]"
            return kept
        case ListNode(items):
            places = [((*at, i), item) for i, item in enumerate(items)]
            return [_without(item, wrong, place) for place, item in places if place not in wrong]
        case ScalarNode():
            return plain_value(node)


def _with_functions(parameter: Parameter, functions: dict[str, str]) -> Parameter:
    """A parameter whose custom validators know their Python functions."""

    def bound(validator: Validator) -> Validator:
        return (
            replace(validator, function=functions.get(validator.name)) if is_custom(validator) else validator
        )

    return replace(parameter, validators=tuple(map(bound, parameter.validators)))


def _terms(options: Options, tree: MapNode, problems: FileProblems) -> Iterator[tuple[str, Terms]]:
    """The terms of endpoints. A version that is none is reported."""
    for name, each in options.endpoints.items():
        node, key = find(tree, ("endpoints", name))
        if re.fullmatch(VERSION, each.version) is None:
            problems.error(_no_version, _place(tree, "endpoints", name, "version"), each.version)
        if each.rate is not None and not 0 < each.rate < math.inf:
            problems.error(_no_period, _place(tree, "endpoints", name, "rate"), "rate")
        span = key.span if key else node.span
        yield name, Terms(**each.model_dump(), span=span)


def _timers(options: Options, tree: MapNode, wrong: Set[Location], problems: FileProblems) -> Iterator[Timer]:
    """The timers that are maps. What is wrong with them is reported, unless it is at `wrong` locations."""
    node = tree.get("timers")
    items = node.items if isinstance(node, ListNode) else ()
    found = [(i, item) for i, item in enumerate(items) if ("timers", i) not in wrong]
    for timer, (i, item) in zip(options.timers, found, strict=True):
        if not _is_identifier(timer.name) and ("timers", i, "name") not in wrong:
            problems.error(_no_identifier, item.span, "name", timer.name)
        yield _timer(timer, item, problems)


def _timer(options: TimerOptions, node: Node, problems: FileProblems) -> Timer:
    said = [key for key in _PERIODS if not _is_nothing(node, key)]
    if len(said) != 1:
        problems.error(_no_one_period, node.span, options.name, said)
    period = options.period
    if options.rate is not None and options.rate > 0:
        period = 1 / options.rate
    if (options.rate is not None or period is not None) and not (period and 0 < period < math.inf):
        problems.error(_no_period, node.span, "rate" if period is None else said[0])
    return Timer(
        options.name, period, options.period_param, options.clock, tuple(options.publishes), node.span
    )


def _is_nothing(node: Node, key: str) -> bool:
    """Whether a map has no value under a key."""
    value = node.get(key) if isinstance(node, MapNode) else None
    return value is None or (isinstance(value, ScalarNode) and value.value is None)


def _is_identifier(text: str) -> bool:
    return text.isascii() and text.isidentifier() and not keyword.iskeyword(text)


def _place(tree: Node, *location: str | int) -> Span:
    node, _ = find(tree, location)
    return node.span


def find(node: Node, location: Location) -> tuple[Node, Key | None]:
    """The node at a location below another, as far as it exists, and its key."""
    key: Key | None = None
    for step in location:
        if isinstance(node, MapNode) and isinstance(step, str):
            value = node.get(step)
            if value is None:
                return node, None
            key, node = node.key(step), value
        elif isinstance(node, ListNode) and isinstance(step, int):
            key, node = None, node.items[step]
    return node, key


def _diagnostic(root: Node, error: dict[str, Any]) -> Diagnostic:
    location: Location = error["loc"]
    node, key = find(root, location)
    shown_location = [str(step) for step in location if isinstance(step, str)]
    inner = _INNER if len(location) > 1 else {}
    what = inner.get(str(next(iter(location), "")), "codegen.ifgen")
    name = f"`{'.'.join(['codegen.ifgen', *shown_location])}`"
    match error["type"]:
        case "extra_forbidden" if key is not None:
            return unknown_key(key, what, _MODELS.get(what, Options).model_fields)
        case "missing":
            return missing_key(str(location[len(location) - 1]), what, node.span)
        case "literal_error":
            options = re.findall(r"'([^']*)'", str(error["ctx"]["expected"]))
            if isinstance(plain_value(node), str):
                return unknown_choice(cast("Any", node), name, options)
            return wrong_value(node, name, f"one of the texts {', '.join(options)}")
        case other:
            return wrong_value(node, name, _EXPECTED.get(other, "something else"))


def _no_style_of_base(span: Span, style: str, base: str) -> Diagnostic:
    return Diagnostic(
        "invalid-option",
        f"a node of the style `{style}` cannot derive from {base}, which an included document names",
        Label(span),
        help="write `style: lifecycle`, or leave it out",
    )


def _no_identifier(span: Span, key: str, text: str) -> Diagnostic:
    return Diagnostic(
        "invalid-option",
        f"`{key}` must be a name in Python, not `{shorten(text)}`",
        Label(span),
        help="letters, digits and underscores, no digit first, and not a Python keyword",
    )


def _no_module(span: Span, text: str) -> Diagnostic:
    message = f"`business_file` must be the file of a Python module, not `{shorten(text)}`"
    return Diagnostic("invalid-option", message, Label(span), help="such as my_node.py, without a folder")


def _no_function(span: Span, text: str) -> Diagnostic:
    message = f"`{shorten(text)}` is not the dotted path of a Python function"
    return Diagnostic("invalid-option", message, Label(span), help="such as my_package.checks.is_odd")


def _no_one_period(span: Span, name: str, said: list[str]) -> Diagnostic:
    what = f"both `{said[0]}` and `{said[1]}`" if said else "no period"
    return Diagnostic(
        "invalid-option",
        f"the timer `{shorten(name)}` has {what}",
        Label(span),
        help="give one of `period` [s], `rate` [Hz] and `period_param` (a double parameter [s])",
    )


def _no_version(span: Span, text: str) -> Diagnostic:
    message = f"`{shorten(text)}` is neither a version nor a range of versions"
    return Diagnostic("invalid-option", message, Label(span), help="such as 2.1.0, or 2.1..3")


def _no_period(span: Span, key: str) -> Diagnostic:
    return Diagnostic("invalid-option", f"`{key}` must be a finite number above 0", Label(span))
