"""Mistakes in a whole node, and in the nodes of a package together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ifgen.diagnostics import Diagnostic
from ifgen.nodl import explain_node as explain
from ifgen.nodl import names
from ifgen.nodl.compatibility import mismatch
from ifgen.nodl.model import Category, Endpoint, NodeDescription, Parameter
from ifgen.nodl.validators import is_custom
from ifgen.nodl.written import Written, may_be

_RESERVED_MODULES = ("__init__.py", "msg.py", "srv.py", "action.py")
"""Other names in the inner folder of a generated package; the last three would hide its interfaces."""


def check_node(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    """The mistakes in one node, whose documents name this."""
    yield from _endpoints(node)
    yield from _methods(node)
    yield from _groups(node)
    yield from _functions(node, written)
    yield from _timers(node, written)


def check_package(nodes: Sequence[NodeDescription]) -> Iterator[Diagnostic]:
    """The mistakes in the nodes of a package together, all running in the root namespace."""
    yield from _modules(nodes)
    publishers: dict[str, list[tuple[NodeDescription, Endpoint]]] = {}
    for node in nodes:
        for publisher in node.publishers:
            publishers.setdefault(names.expanded(publisher.name, node.name), []).append((node, publisher))
    for node in nodes:
        for subscription in node.subscriptions:
            for sender, publisher in publishers.get(names.expanded(subscription.name, node.name), ()):
                # Two types within one node are an error.
                if publisher.type_name != subscription.type_name and sender is not node:
                    why = f"{publisher.type_name} is published, {subscription.type_name} subscribed to"
                    yield explain.never_meet(publisher, subscription, sender, why)
                elif publisher.qos and subscription.qos:
                    mismatched = mismatch(publisher.qos, subscription.qos)
                    if mismatched and publisher.type_name == subscription.type_name:
                        yield explain.never_meet(publisher, subscription, sender, mismatched)


def _endpoints(node: NodeDescription) -> Iterator[Diagnostic]:
    """Names that mean the same once they are expanded."""
    by_name: dict[tuple[str, str], Endpoint] = {}
    in_category: dict[tuple[Category, str], Endpoint] = {}
    for endpoint in node.endpoints:
        name = names.expanded(endpoint.name, node.name)
        first = by_name.setdefault((endpoint.category.folder, name), endpoint)
        if first.type_name != endpoint.type_name:
            yield explain.two_types(name, endpoint, first)
        same = in_category.setdefault((endpoint.category, name), endpoint)
        if same is not endpoint:
            yield explain.same_when_expanded(name, endpoint, same)


def _methods(node: NodeDescription) -> Iterator[Diagnostic]:
    """Endpoints of one category whose methods would be called the same: `/a/b` and `a_b`."""
    first: dict[tuple[Category, str], Endpoint] = {}
    for endpoint in node.endpoints:
        stem = names.stem(endpoint.name)
        other = first.setdefault((endpoint.category, stem), endpoint)
        full_names = {names.expanded(e.name, node.name) for e in (endpoint, other)}
        if other is not endpoint and len(full_names) > 1:
            yield explain.same_methods(stem, endpoint, other)


def _groups(node: NodeDescription) -> Iterator[Diagnostic]:
    by_name = {parameter.name: parameter for parameter in node.parameters}
    for parameter in node.parameters:
        parts = parameter.name.split(".")
        groups = (".".join(parts[:length]) for length in range(1, len(parts)))
        for group in groups:
            if group in by_name:
                yield explain.value_and_group(parameter, by_name[group])


def _functions(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    for parameter in node.parameters:
        for validator in parameter.validators:
            has_none = is_custom(validator) and validator.function is None
            if has_none and not may_be(validator.name, written.functions):
                yield explain.missing_function(validator)


def _timers(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    parameters = {parameter.name: parameter for parameter in node.parameters}
    publishers = [publisher.name for publisher in node.publishers]
    seen: set[str] = set()
    for timer in node.timers:
        if timer.name in seen:
            yield explain.duplicate_timer(timer)
        seen.add(timer.name)
        for name in timer.publishes:
            if name not in publishers and not may_be(name, written.publishers):
                yield explain.unknown_publisher(timer, name, publishers)
        if timer.period_parameter is None:
            continue
        parameter = parameters.get(timer.period_parameter)
        if parameter is None:
            if not may_be(timer.period_parameter, written.parameters):
                doubles = [name for name, known in parameters.items() if _is_double(known)]
                yield explain.unknown_parameter(timer, timer.period_parameter, doubles)
        elif not _is_double(parameter):
            yield explain.no_double(timer, parameter)
        elif isinstance(parameter.default, float) and not parameter.default > 0:
            yield explain.no_period(timer, parameter)
    yield from _late_timers(node)


def _late_timers(node: NodeDescription) -> Iterator[Diagnostic]:
    """Timers that publish less often than their publishers promise."""
    defaults = {parameter.name: parameter.default for parameter in node.parameters}
    for timer in node.timers:
        period = timer.period if timer.period_parameter is None else defaults.get(timer.period_parameter)
        for publisher in node.publishers:
            deadline = publisher.qos.deadline_ns / 1e9 if publisher.qos else 0.0
            if publisher.name in timer.publishes and isinstance(period, float) and 0 < deadline < period:
                yield explain.late_timer(timer, publisher, period, deadline)


def _is_double(parameter: Parameter) -> bool:
    return parameter.type.base == "double" and not parameter.type.array


def _modules(nodes: Sequence[NodeDescription]) -> Iterator[Diagnostic]:
    """Files that two nodes of a package would both be written to."""
    taken: dict[str, NodeDescription] = {}
    for node in nodes:
        if node.business_file in _RESERVED_MODULES:
            yield explain.reserved_module(node)
        for file in (f"_{node.name}_base.py", f"_{node.name}_parameters.py", node.business_file):
            other = taken.setdefault(file, node)
            if other is not node:
                yield explain.same_module(node, other, file)
    for node in nodes:
        for validator in (v for parameter in node.parameters for v in parameter.validators):
            module = (validator.function or "").rpartition(".")[0]
            file = f"{module.removeprefix(f'{node.package}.')}.py"
            if module.startswith(f"{node.package}.") and file in taken:
                yield explain.function_in_node(validator, file)
