"""Explanations of mistakes in a whole node: endpoints, parameters and timers that do not fit together."""

from __future__ import annotations

from collections.abc import Iterable

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl.model import Endpoint, NodeDescription, Parameter, Timer, Validator
from ifgen.nodl.values import spelled


def never_meet(publisher: Endpoint, subscription: Endpoint, sender: NodeDescription, why: str) -> Diagnostic:
    """Say that a subscription gets nothing from a publisher of the same package."""
    return Diagnostic(
        "never-meet",
        f"this subscription receives nothing from the publisher of node '{sender.name}': {why}",
        _label(subscription.qos.span if subscription.qos else subscription.span, "requested"),
        _labels(publisher.qos.span if publisher.qos else publisher.span, "offered"),
        "change one of the two; `ros2 topic info -v` would show both, but nothing would arrive",
        severity="warning",
    )


def two_types(name: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
    """Say that a node uses one name with two types."""
    return Diagnostic(
        "two-types",
        f"`{name}` is of type {endpoint.type_name} here and of type {first.type_name} elsewhere in the node",
        _label(endpoint.span, endpoint.type_name),
        _labels(first.span, first.type_name),
        "the two can never match: rename one of them, or give both the same type",
    )


def same_when_expanded(name: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
    """Say that two names are one once they are expanded."""
    return Diagnostic(
        "duplicate-endpoint",
        f"there are two {endpoint.category.singular}s named `{name}`",
        _label(endpoint.span, f"this is `{name}`"),
        _labels(first.span, "and so is this"),
        "if the node is in the root namespace; rename one of them, or leave it out",
    )


def same_methods(stem: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
    """Say that the methods of two endpoints cannot both have the plain name."""
    what = endpoint.category.singular
    return Diagnostic(
        "same-method",
        f"the methods of two {what}s would both be named after `{stem}`",
        _label(endpoint.span, "these get a longer name"),
        _labels(first.span, "these get the plain one"),
        "rename one of the two for readable code",
        severity="warning",
    )


def value_and_group(parameter: Parameter, group: Parameter) -> Diagnostic:
    """Say that a parameter is a group of others too."""
    return Diagnostic(
        "value-and-group",
        f"`{group.name}` cannot be both a parameter and the group of `{parameter.name}`",
        _label(parameter.span, "needs the group"),
        _labels(group.span, "is a parameter"),
        "rename one of them",
    )


def missing_function(validator: Validator) -> Diagnostic:
    """Say that a custom validator has no function in Python."""
    path = validator.name.replace("::", ".")
    return Diagnostic(
        "missing-function",
        f"the validator `{shorten(validator.name)}` has no function in Python",
        _label(validator.span),
        help="name one under codegen.ifgen: "
        f"`validators: {{{shorten(validator.name)}: {shorten(path)}}}`, a function of the value and the "
        "arguments that raises ValueError with what is wrong",
    )


def duplicate_timer(timer: Timer) -> Diagnostic:
    """Say that two timers have one name."""
    message = f"there are two timers named `{shorten(timer.name)}`"
    return Diagnostic("duplicate-timer", message, _label(timer.span), help="rename one of them")


def unknown_publisher(timer: Timer, name: str, publishers: Iterable[str]) -> Diagnostic:
    """Say that a timer publishes what the node does not."""
    publishers = list(publishers)
    listed = (
        f"the publishers are {shorten(', '.join(publishers), 200)}"
        if publishers
        else "the node has no publishers"
    )
    return Diagnostic(
        "unknown-publisher",
        f"the timer `{shorten(timer.name)}` names a publisher `{shorten(name)}` that the node lacks",
        _label(timer.span),
        help=did_you_mean(name, publishers) or listed,
    )


def unknown_parameter(timer: Timer, name: str, parameters: Iterable[str]) -> Diagnostic:
    """Say that a timer takes its period from a parameter that there is not."""
    parameters = list(parameters)
    listed = (
        f"the parameters of type double are {shorten(', '.join(parameters), 200)}" if parameters else None
    )
    return Diagnostic(
        "unknown-parameter",
        f"the timer `{shorten(timer.name)}` names a parameter `{shorten(name)}` that the node lacks",
        _label(timer.span),
        help=did_you_mean(name, parameters) or listed or "add it: a double, the period in seconds",
    )


def no_double(timer: Timer, parameter: Parameter) -> Diagnostic:
    """Say that a timer cannot take its period from a parameter of a type."""
    return Diagnostic(
        "unknown-parameter",
        f"the period of the timer `{shorten(timer.name)}` must be a double, the parameter "
        f"`{shorten(parameter.name)}` is of type `{spelled(parameter.type)}`",
        _label(timer.span),
        _labels(parameter.span, "the parameter"),
        "make it a double, in seconds",
    )


def no_period(timer: Timer, parameter: Parameter) -> Diagnostic:
    """Say that the default of a period is no period."""
    return Diagnostic(
        "rejected-default",
        f"the timer `{shorten(timer.name)}` would have no period above 0 s",
        _label(parameter.span, "its default must be above 0"),
        _labels(timer.span, "the timer"),
        "change the default, and add the validator `gt: 0.0`",
    )


def late_timer(timer: Timer, publisher: Endpoint, period: float, deadline: float) -> Diagnostic:
    """Say that a publisher misses the deadline that it offers."""
    return Diagnostic(
        "late-timer",
        f"the timer `{shorten(timer.name)}` publishes every {period:g} s, "
        f"but must do so every {deadline:g} s",
        _label(timer.span, "too slow"),
        _labels(publisher.qos.span if publisher.qos else publisher.span, "the deadline"),
        "make the timer faster, or the deadline longer",
        severity="warning",
    )


def reserved_module(node: NodeDescription) -> Diagnostic:
    """Say that a node's module would stand in the way of others."""
    return Diagnostic(
        "same-module",
        f"the module {node.business_file} of node '{node.name}' would hide another module of its package",
        _label(node.span),
        help="rename the node, or name another `business_file` under codegen.ifgen",
    )


def function_in_node(validator: Validator, file: str) -> Diagnostic:
    """Say that a module needs the parameters that need the function in it."""
    return Diagnostic(
        "validator-module",
        f"the function of `{shorten(validator.name)}` cannot be in {file}, which is a module of a node: "
        "that imports the parameters, and they would import it",
        _label(validator.span),
        help="put it into a separate module, such as `checks`",
    )


def same_module(node: NodeDescription, other: NodeDescription, file: str) -> Diagnostic:
    """Say that two nodes would be written to one file."""
    return Diagnostic(
        "same-module",
        f"the nodes '{node.name}' and '{other.name}' would both be written to {file}",
        _label(node.span),
        _labels(other.span, "the other one"),
        "rename one of them, or its `business_file` under codegen.ifgen",
    )


def _label(span: Span | None, text: str = "") -> Label:
    assert span is not None, "what is read from a file has a place"
    return Label(span, text)


def _labels(span: Span | None, text: str) -> tuple[Label, ...]:
    return (_label(span, text),)
