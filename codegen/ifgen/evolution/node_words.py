"""The diagnostics of edits of nodes."""

from __future__ import annotations

from typing import assert_never

from ifgen.diagnostics import Span, shorten
from ifgen.evolution.edits import (
    EndpointAdded,
    EndpointRemoved,
    EndpointRenamed,
    EndpointRetyped,
    NodeAdded,
    NodeClassChanged,
    NodeEdit,
    NodeRemoved,
    NodeRenamed,
    ParameterAccessChanged,
    ParameterAdded,
    ParameterDefaultChanged,
    ParameterRemoved,
    ParameterRenamed,
    ParameterRetyped,
    QosChanged,
    ValidatorsChanged,
)
from ifgen.evolution.words_of_places import Said
from ifgen.nodl.model import Endpoint, NodeDescription, Parameter, ParameterType


def said(edit: NodeEdit) -> Said | None:
    """The words for an edit; None for one that breaks nothing."""
    match edit:
        case NodeAdded() | EndpointAdded():
            return None
        case NodeRemoved(node):
            return Said("node-removed", f"node {_name(node)} is gone", old=(node.span, "it was here"))
        case NodeRenamed(old, new):
            message = f"node {_name(old)} is now {_name(new)}"
            return Said("node-renamed", message, (new.span, ""), (old.span, "the same under its old name"))
        case NodeClassChanged(old, new):
            message = f"the class of node {_name(new)} was {_class(old)}, and is {_class(new)}"
            return Said("node-class", message, (new.span, ""), (old.span, "before"))
        case EndpointRemoved(node, endpoint):
            message = f"{_endpoint(node, endpoint)} is gone"
            return Said("endpoint-removed", message, (node.span, ""), (endpoint.span, "this one"))
        case EndpointRenamed(node, old, new):
            message = f"{_endpoint(node, new)} was called `{shorten(old.name)}`"
            return Said("endpoint-renamed", message, (new.span, ""), (old.span, "before"))
        case EndpointRetyped(node, old, new):
            message = f"{_endpoint(node, new)} was of type {old.type_name}, and is of {new.type_name}"
            return Said("endpoint-type", message, (new.span, ""), (old.span, "before"))
        case QosChanged(node, old, new, mismatch):
            message = f"{_endpoint(node, new)} no longer matches its peers: {mismatch}"
            return Said("qos-incompatible", message, (_qos(new), ""), (_qos(old), "before"))
        case _:
            return _of_parameter(edit)


def _of_parameter(
    edit: ParameterAdded
    | ParameterRemoved
    | ParameterRenamed
    | ParameterRetyped
    | ParameterDefaultChanged
    | ParameterAccessChanged
    | ValidatorsChanged,
) -> Said:
    match edit:
        case ParameterAdded(node, parameter):
            message = f"{_parameter(node, parameter)} is new, and has no default"
            return Said("parameter-required", message, (parameter.span, "each start must give it a value"))
        case ParameterRemoved(node, parameter):
            message = f"{_parameter(node, parameter)} is gone"
            return Said("parameter-removed", message, (node.span, ""), (parameter.span, "this one"))
        case ParameterRenamed(node, old, new):
            message = f"{_parameter(node, new)} was called `{shorten(old.name)}`"
            return Said("parameter-renamed", message, (new.span, ""), (old.span, "before"))
        case ParameterRetyped(node, old, new):
            message = f"{_parameter(node, new)} was of type {_type(old.type)}, and is of {_type(new.type)}"
            return Said("parameter-type", message, (new.span, ""), (old.span, "before"))
        case ParameterDefaultChanged(node, old, new) if new.is_required:
            message = f"{_parameter(node, new)} has no default any more"
            there = "each start must give it a value"
            return Said("parameter-required", message, (new.span, there), (old.span, "before"))
        case ParameterDefaultChanged(node, old, new):
            was, is_ = shorten(repr(old.default)), shorten(repr(new.default))
            message = f"the default of {_parameter(node, new)} was {was}, and is {is_}"
            return Said("parameter-default", message, (new.span, ""), (old.span, "before"))
        case ParameterAccessChanged(node, old, new):
            message = f"{_parameter(node, new)} is now read-only"
            return Said("parameter-read-only", message, (new.span, ""), (old.span, "before"))
        case ValidatorsChanged(node, old, new):
            message = f"{_parameter(node, new)} may refuse values that it took before"
            return Said("parameter-validation", message, (_validation(new), ""), (_validation(old), "before"))
        case _:
            assert_never(edit)


def _name(node: NodeDescription) -> str:
    return f"{node.package}/{node.name}"


def _class(node: NodeDescription) -> str:
    kind = {"callbacks": "of callbacks", "lifecycle": "with a lifecycle", "asyncio": "of coroutines"}
    return f"{node.node_class} {kind[node.style]}"


def _endpoint(node: NodeDescription, endpoint: Endpoint) -> str:
    return f"{endpoint.category.singular} `{shorten(endpoint.name)}` of node {_name(node)}"


def _parameter(node: NodeDescription, parameter: Parameter) -> str:
    return f"parameter `{shorten(parameter.name)}` of node {_name(node)}"


def _type(type_: ParameterType) -> str:
    array = "_array" if type_.array else ""
    return f"{type_.base}{array}{f'_fixed_{type_.fixed_size}' if type_.fixed_size is not None else ''}"


def _qos(endpoint: Endpoint) -> Span | None:
    """The place of a QoS profile, as short as its first line."""
    span = endpoint.qos.span if endpoint.qos is not None else None
    return endpoint.span if span is None else _first_line(span)


def _validation(parameter: Parameter) -> Span | None:
    span = parameter.validators[0].span if parameter.validators else None
    return parameter.span if span is None else _first_line(span)


def _first_line(span: Span) -> Span:
    end = span.source.text.find("\n", span.start, span.end)
    return span if end < 0 else Span(span.source, span.start, end)
