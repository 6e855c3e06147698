"""YAML of a document: what a description says, as every reader of YAML understands it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from ifgen.nodl.model import (
    Category,
    Endpoint,
    Interface,
    NodeDescription,
    Parameter,
    ParameterValue,
    QosProfile,
    Validator,
)
from ifgen.nodl.syntax.scalars import quoted
from ifgen.nodl.validators import is_custom
from ifgen.nodl.values import spelled

_WORDS: Final = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})


def description_lines(node: NodeDescription) -> Iterator[str]:
    """The document after `nodl_version`, for the ament index: its parts in one place.

    What it says to tools other than ifgen stays, and so do includes of documents whose code exists: whoever
    includes this one generates nothing for those.
    """
    if node.description:
        yield f"description: {quoted(node.description)}"
    if node.codegen:
        yield "codegen:"
        yield from (f"  {yaml_key(tool)}: {options}" for tool, options in node.codegen)
    if node.references:
        yield "include:"
        yield from (f"  - ref: {reference}" for reference in node.references)
    own = Interface(node.parameters, node.endpoints) + node.reserved
    if own.parameters:
        yield "parameters:"
        for parameter in own.parameters:
            yield from _parameter(parameter)
    for category in Category:
        endpoints = [endpoint for endpoint in own.endpoints if endpoint.category == category]
        if endpoints:
            yield f"{category.value}:"
            for endpoint in endpoints:
                yield from _endpoint(endpoint)


def _parameter(parameter: Parameter) -> Iterator[str]:
    yield f"  {yaml_key(parameter.name)}:"
    yield f"    type: {spelled(parameter.type)}"
    if parameter.default is not None:
        yield f"    default_value: {yaml_value(parameter.default)}"
    if parameter.description:
        yield f"    description: {quoted(parameter.description)}"
    if parameter.read_only:
        yield "    read_only: true"
    if parameter.additional_constraints:
        yield f"    additional_constraints: {quoted(parameter.additional_constraints)}"
    if parameter.validators:
        yield "    validation:"
        for validator in parameter.validators:
            mark = "" if is_custom(validator) else "<>"  # NoDL's schema takes it for its own only
            yield f"      {validator.name}{mark}: {_arguments(validator)}"


def yaml_key(name: str) -> str:
    """A name as a key: YAML 1.1 reads some words as something else."""
    return quoted(name) if name.lower() in _WORDS else name


def _arguments(validator: Validator) -> str:
    listed = _flow(map(yaml_value, validator.arguments))
    return f"[{listed}]" if validator.name in {"one_of", "subset_of"} else listed


def _endpoint(endpoint: Endpoint) -> Iterator[str]:
    yield f"  - name: {endpoint.name}"
    yield f"    type: {endpoint.type_name}"
    if endpoint.qos:
        yield f"    qos: {{{', '.join(f'{key}: {value}' for key, value in _qos(endpoint.qos))}}}"
    if endpoint.description:
        yield f"    description: {quoted(endpoint.description)}"


def _qos(qos: QosProfile) -> Sequence[tuple[str, object]]:
    policies: Sequence[tuple[str, object]] = (
        ("history", qos.history),
        ("depth", qos.depth),
        ("reliability", qos.reliability),
        ("durability", qos.durability),
        ("deadline_ns", qos.deadline_ns),
        ("lifespan_ns", qos.lifespan_ns),
        ("liveliness", qos.liveliness),
        ("liveliness_lease_duration_ns", qos.liveliness_lease_duration_ns),
    )
    return [(name, value) for name, value in policies if value]


def yaml_value(value: ParameterValue) -> str:
    """A value of a parameter in YAML."""
    match value:
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case float():
            return _number(value)
        case str():
            return quoted(value)
        case bytes() | tuple():
            return _flow(map(yaml_value, value))


def _flow(items: Iterable[str]) -> str:
    return f"[{', '.join(items)}]"


def _number(value: float) -> str:
    """A float that every YAML reads as one: 1.0e-05 where Python writes 1e-05."""
    if not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    mantissa, exponent, power = repr(value).partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}{exponent}{power}" if exponent else repr(value)
