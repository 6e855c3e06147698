"""Mistakes in a whole node, and in the nodes of a package together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names
from ifgen.nodl.document import Written, may_be
from ifgen.nodl.model import Category, Endpoint, NodeDescription, Parameter, Timer, Validator, qos_mismatch
from ifgen.nodl.validators import is_custom
from ifgen.nodl.values import spelled

_RESERVED_MODULES = ("__init__.py", "msg.py", "srv.py", "action.py")
"""Other names in the inner folder of a generated package; the last three would hide its interfaces."""


def check_node(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    """The mistakes in one node, whose documents name this."""
    yield from _endpoints(node)
    yield from _methods(node)
    yield from _groups(node)
    yield from _functions(node, written)
    yield from _timers(node, written)
    if written.publishers is not None:  # every document could be read
        yield from _terms(node)


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
                    yield _never_meet(publisher, subscription, sender, why)
                elif publisher.qos and subscription.qos:
                    mismatched = qos_mismatch(publisher.qos, subscription.qos)
                    if mismatched and publisher.type_name == subscription.type_name:
                        yield _never_meet(publisher, subscription, sender, mismatched)


def _endpoints(node: NodeDescription) -> Iterator[Diagnostic]:
    """Names that mean the same once they are expanded."""
    by_name: dict[tuple[str, str], Endpoint] = {}
    in_category: dict[tuple[Category, str], Endpoint] = {}
    for endpoint in node.endpoints:
        name = names.expanded(endpoint.name, node.name)
        first = by_name.setdefault((endpoint.category.folder, name), endpoint)
        if first.type_name != endpoint.type_name:
            yield _two_types(name, endpoint, first)
        same = in_category.setdefault((endpoint.category, name), endpoint)
        if same is not endpoint:
            yield _same_when_expanded(name, endpoint, same)


def _methods(node: NodeDescription) -> Iterator[Diagnostic]:
    """Endpoints of one category whose methods would be called the same: `/a/b` and `a_b`."""
    first: dict[tuple[Category, str], Endpoint] = {}
    for endpoint in node.endpoints:
        stem = names.stem(endpoint.name)
        other = first.setdefault((endpoint.category, stem), endpoint)
        full_names = {names.expanded(e.name, node.name) for e in (endpoint, other)}
        if other is not endpoint and len(full_names) > 1:
            yield _same_methods(stem, endpoint, other)


def _groups(node: NodeDescription) -> Iterator[Diagnostic]:
    by_name = {parameter.name: parameter for parameter in node.parameters}
    for parameter in node.parameters:
        parts = parameter.name.split(".")
        groups = (".".join(parts[:length]) for length in range(1, len(parts)))
        for group in groups:
            if group in by_name:
                yield _value_and_group(parameter, by_name[group])


def _functions(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    for parameter in node.parameters:
        for validator in parameter.validators:
            has_none = is_custom(validator) and validator.function is None
            if has_none and not may_be(validator.name, written.functions):
                yield _missing_function(validator)


def _timers(node: NodeDescription, written: Written) -> Iterator[Diagnostic]:
    parameters = {parameter.name: parameter for parameter in node.parameters}
    publishers = [publisher.name for publisher in node.publishers]
    seen: set[str] = set()
    for timer in node.timers:
        if timer.name in seen:
            yield _duplicate_timer(timer)
        seen.add(timer.name)
        for name in timer.publishes:
            if name not in publishers and not may_be(name, written.publishers):
                yield _unknown_publisher(timer, name, publishers)
        if timer.period_parameter is None:
            continue
        parameter = parameters.get(timer.period_parameter)
        if parameter is None:
            if not may_be(timer.period_parameter, written.parameters):
                doubles = [name for name, known in parameters.items() if _is_double(known)]
                yield _unknown_parameter(timer, timer.period_parameter, doubles)
        elif not _is_double(parameter):
            yield _no_double(timer, parameter)
        elif isinstance(parameter.default, float) and not parameter.default > 0:
            yield _no_period(timer, parameter)
    yield from _late_timers(node)


def _terms(node: NodeDescription) -> Iterator[Diagnostic]:
    """Terms of endpoints that the node does not have."""
    known = {endpoint.name for endpoint in node.whole.endpoints}
    for name, terms in node.terms:
        if name not in known:
            yield Diagnostic(
                "invalid-option",
                f"the terms are of an endpoint `{shorten(name)}` that the node lacks",
                _label(terms.span),
                help=did_you_mean(name, known) or "write its name as the endpoint has it",
            )


def _late_timers(node: NodeDescription) -> Iterator[Diagnostic]:
    """Timers that publish less often than their publishers promise."""
    defaults = {parameter.name: parameter.default for parameter in node.parameters}
    for timer in node.timers:
        period = timer.period if timer.period_parameter is None else defaults.get(timer.period_parameter)
        for publisher in node.publishers:
            deadline = publisher.qos.deadline_ns / 1e9 if publisher.qos else 0.0
            if publisher.name in timer.publishes and isinstance(period, float) and 0 < deadline < period:
                yield _late_timer(timer, publisher, period, deadline)


def _is_double(parameter: Parameter) -> bool:
    return parameter.type.base == "double" and not parameter.type.array


def _modules(nodes: Sequence[NodeDescription]) -> Iterator[Diagnostic]:
    """Files that two nodes of a package would both be written to."""
    taken: dict[str, NodeDescription] = {}
    for node in nodes:
        if node.business_file in _RESERVED_MODULES:
            yield _reserved_module(node)
        for file in (f"_{node.name}_base.py", f"_{node.name}_parameters.py", node.business_file):
            other = taken.setdefault(file, node)
            if other is not node:
                yield _same_module(node, other, file)
    for node in nodes:
        for validator in (v for parameter in node.parameters for v in parameter.validators):
            module = (validator.function or "").rpartition(".")[0]
            file = f"{module.removeprefix(f'{node.package}.')}.py"
            if module.startswith(f"{node.package}.") and file in taken:
                yield _function_in_node(validator, file)


def _never_meet(publisher: Endpoint, subscription: Endpoint, sender: NodeDescription, why: str) -> Diagnostic:
    """Say that a subscription gets nothing from a publisher of the same package."""
    return Diagnostic(
        "never-meet",
        f"this subscription receives nothing from the publisher of node '{sender.name}': {why}",
        _label(subscription.qos.span if subscription.qos else subscription.span, "requested"),
        _labels(publisher.qos.span if publisher.qos else publisher.span, "offered"),
        "change one of the two; `ros2 topic info -v` would show both, but nothing would arrive",
        severity="warning",
    )


def _two_types(name: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
    """Say that a node uses one name with two types."""
    return Diagnostic(
        "two-types",
        f"`{name}` is of type {endpoint.type_name} here and of type {first.type_name} elsewhere in the node",
        _label(endpoint.span, endpoint.type_name),
        _labels(first.span, first.type_name),
        "the two can never match: rename one of them, or give both the same type",
    )


def _same_when_expanded(name: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
    """Say that two names are one once they are expanded."""
    return Diagnostic(
        "same-endpoint",
        f"there are two {endpoint.category.singular}s named `{name}`",
        _label(endpoint.span, f"this is `{name}`"),
        _labels(first.span, "and so is this"),
        "if the node is in the root namespace; rename one of them, or leave it out",
    )


def _same_methods(stem: str, endpoint: Endpoint, first: Endpoint) -> Diagnostic:
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


def _value_and_group(parameter: Parameter, group: Parameter) -> Diagnostic:
    """Say that a parameter is a group of others too."""
    return Diagnostic(
        "value-and-group",
        f"`{group.name}` cannot be both a parameter and the group of `{parameter.name}`",
        _label(parameter.span, "needs the group"),
        _labels(group.span, "is a parameter"),
        "rename one of them",
    )


def _missing_function(validator: Validator) -> Diagnostic:
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


def _duplicate_timer(timer: Timer) -> Diagnostic:
    """Say that two timers have one name."""
    message = f"there are two timers named `{shorten(timer.name)}`"
    return Diagnostic("duplicate-timer", message, _label(timer.span), help="rename one of them")


def _unknown_publisher(timer: Timer, name: str, publishers: Iterable[str]) -> Diagnostic:
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


def _unknown_parameter(timer: Timer, name: str, parameters: Iterable[str]) -> Diagnostic:
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


def _no_double(timer: Timer, parameter: Parameter) -> Diagnostic:
    """Say that a timer cannot take its period from a parameter of a type."""
    return Diagnostic(
        "unknown-parameter",
        f"the period of the timer `{shorten(timer.name)}` must be a double, the parameter "
        f"`{shorten(parameter.name)}` is of type `{spelled(parameter.type)}`",
        _label(timer.span),
        _labels(parameter.span, "the parameter"),
        "make it a double, in seconds",
    )


def _no_period(timer: Timer, parameter: Parameter) -> Diagnostic:
    """Say that the default of a period is no period."""
    return Diagnostic(
        "rejected-default",
        f"the timer `{shorten(timer.name)}` would have no period above 0 s",
        _label(parameter.span, "its default must be above 0"),
        _labels(timer.span, "the timer"),
        "change the default, and add the validator `gt: 0.0`",
    )


def _late_timer(timer: Timer, publisher: Endpoint, period: float, deadline: float) -> Diagnostic:
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


def _reserved_module(node: NodeDescription) -> Diagnostic:
    """Say that a node's module would stand in the way of others."""
    return Diagnostic(
        "same-module",
        f"the module {node.business_file} of node '{node.name}' would hide another module of its package",
        _label(node.span),
        help="rename the node, or name another `business_file` under codegen.ifgen",
    )


def _function_in_node(validator: Validator, file: str) -> Diagnostic:
    """Say that a module needs the parameters that need the function in it."""
    return Diagnostic(
        "validator-module",
        f"the function of `{shorten(validator.name)}` cannot be in {file}, which is a module of a node: "
        "that imports the parameters, and they would import it",
        _label(validator.span),
        help="put it into a separate module, such as `checks`",
    )


def _same_module(node: NodeDescription, other: NodeDescription, file: str) -> Diagnostic:
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
