"""Differences between what a document says of a node and what the node, or another document, has."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from types import MappingProxyType
from typing import Any, Final, Literal, get_args

from ifgen.diagnostics import Diagnostic, Label, Span, UsageError
from ifgen.nodl import names
from ifgen.nodl.model import Category, Interface, Parameter, QosProfile, qos_mismatch
from ifgen.nodl.values import spelled

from ifgen_tools import ros_graph
from ifgen_tools.nodl.parameters import RunningParameter

Kind = Literal[
    "missing", "extra", "type_mismatch", "qos_mismatch", "hash_mismatch", "property_mismatch", "unverifiable"
]
_PARAMETERS: Final = "parameters"
_SECTIONS: Final = (*(category.value for category in Category), _PARAMETERS)
_POLICIES: Final = ("history", "reliability", "durability", "liveliness")
_DURATIONS: Final = ("deadline_ns", "lifespan_ns", "liveliness_lease_duration_ns")
_OPEN: Final = frozenset({None, "SYSTEM_DEFAULT", "BEST_AVAILABLE"})
_LIMITS: Final = frozenset({"lt", "gt", "lt_eq", "gt_eq", "element_bounds"})
_IGNORE: Final = re.compile(r"(?P<kind>[a-z_]+):(?P<name>[^:\s]+)(?::(?P<type>[^:\s]+))?")


@dataclass(frozen=True, slots=True)
class Difference:
    """A difference: its kind, the list and the name in the document, and the place there, if it has one."""

    kind: Kind
    section: str
    name: str
    detail: str
    span: Span | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        return f"[{self.kind}] {self.section} '{self.name}': {self.detail}"


@dataclass(frozen=True, slots=True)
class End:
    """An endpoint with its full name; `type_hash` is None where nobody says it.

    `parts` are the hashes of the messages and services that a service or an action consists of, by type.
    """

    category: Category
    name: str
    type_name: str
    qos: QosProfile | None = None
    type_hash: str | None = None
    parts: Mapping[str, str] = field(default_factory=dict)
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Value:
    """A parameter; `default` is None where there is none, `bounds` where there is no range.

    `is_bounded_size` is true for a type of fixed size, and `is_limited` if there are limits besides bounds.
    """

    name: str
    type: str
    default: Any = None
    read_only: bool = False
    bounds: tuple[float, float] | None = None
    is_bounded_size: bool = False
    is_limited: bool = False
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Side:
    """All endpoints and parameters of a node; the parameters are None if nobody knows them."""

    ends: tuple[End, ...]
    parameters: tuple[Value, ...] | None


@dataclass(frozen=True, slots=True)
class Choices:
    """How strictly to compare: QoS that is `compatible` may do, and `defaults` may count or not."""

    compatible: bool = False
    defaults: bool = True
    ignore: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Report:
    """The differences in the order of a document, and the extra parts that were to be ignored."""

    differences: tuple[Difference, ...]
    ignored: tuple[Difference, ...]

    @property
    def failures(self) -> tuple[Difference, ...]:
        """The differences that are certain."""
        return tuple(found for found in self.differences if found.kind != "unverifiable")


def full_name(name: str, node: str) -> str:
    """The full name of an endpoint of a node, whose own name is full."""
    namespace = node.rpartition("/")[0]
    if name.startswith("~"):
        return f"{node}{name[1:]}"
    return name if name.startswith("/") else f"{namespace}/{name}"


def side_of_document(
    interface: Interface,
    node: str,
    *,
    remaps: Sequence[tuple[str, str]] = (),
    hashes: Mapping[str, str] = MappingProxyType({}),
) -> Side:
    """The side of a document, for a node of this full name that is started with these remaps.

    `hashes` are those of types that can be found.
    """
    new_names = {full_name(old, node): full_name(new, node) for old, new in remaps}
    ends = []
    for endpoint in interface.endpoints:
        name = full_name(endpoint.name, node)
        end = End(
            endpoint.category,
            new_names.get(name, name),
            endpoint.type_name,
            endpoint.qos,
            hashes.get(endpoint.type_name) if endpoint.category.folder == "msg" else None,
            {} if endpoint.category.folder == "msg" else hashes,
            endpoint.span,
        )
        ends.append(end)
    own = (each for each in interface.parameters if not names.reserved_parameter(each.name))
    return Side(_of_authors(ends, node), tuple(_declared(each) for each in own))


def side_of_node(
    node: str,
    endpoints: Iterable[ros_graph.Endpoint],
    parameters: Sequence[RunningParameter] | None,
    parts: Mapping[tuple[Category, str], Mapping[str, str]] = MappingProxyType({}),
) -> Side:
    """The side of a running node; its parameters are None if its services do not answer.

    `parts` are the hashes that the parts of services and actions have, by category and name.
    """
    ends = (
        End(
            each.category,
            each.name,
            each.type_name,
            each.qos,
            each.type_hash,
            parts.get((each.category, each.name), {}),
        )
        for each in endpoints
        if each.node == node
    )
    values = [
        Value(each.name, each.type, each.value, each.read_only, each.bounds)
        for each in parameters or ()
        if not names.reserved_parameter(each.name)
    ]
    return Side(_of_authors(ends, node), None if parameters is None else tuple(values))


def compare(expected: Side, actual: Side, choices: Choices) -> Report:
    """All differences. Raises UsageError for an ignore rule that is none."""
    rules = [_ignore_rule(text) for text in choices.ignore]
    found = [*_endpoints(expected.ends, actual.ends, choices)]
    if actual.parameters is None:
        found += (
            Difference("unverifiable", _PARAMETERS, each.name, "its services do not answer", each.span)
            for each in expected.parameters or ()
        )
    else:
        found += _parameters(expected.parameters or (), actual.parameters, choices)
    types = {(end.category.value, end.name): end.type_name for end in actual.ends}
    ignored = [each for each in found if any(_is_ignored(each, rule, types) for rule in rules)]
    order = {section: number for number, section in enumerate(_SECTIONS)}
    kept = [each for each in found if each not in ignored]
    kept.sort(key=lambda each: (order[each.section], each.name, get_args(Kind).index(each.kind), each.detail))
    return Report(tuple(kept), tuple(ignored))


def diagnostics(report: Report) -> list[Diagnostic]:
    """The differences as annotations of a document: what cannot be verified is a warning."""
    return [
        Diagnostic(
            each.kind.replace("_", "-"),
            f"{each.section} '{each.name}': {each.detail}",
            Label(each.span) if each.span else None,
            severity="warning" if each.kind == "unverifiable" else "error",
        )
        for each in report.differences
    ]


def _of_authors(ends: Iterable[End], node: str) -> tuple[End, ...]:
    """Those that the framework does not make, each once."""
    kept: dict[tuple[Category, str, str], End] = {}
    for end in ends:
        seen = ros_graph.Endpoint(node, end.name, end.category, end.type_name)
        if not seen.is_of_framework and not ros_graph.is_hidden(end.name):
            kept.setdefault((end.category, end.name, end.type_name), end)
    return tuple(kept.values())


def _declared(parameter: Parameter) -> Value:
    default: Any = parameter.default
    arguments = {each.name: each.arguments for each in parameter.validators}
    bounds: Any = None if parameter.type.array else arguments.get("bounds")
    return Value(
        parameter.name,
        spelled(parameter.type),
        list(default) if isinstance(default, bytes | tuple) else default,
        parameter.read_only,
        bounds,
        parameter.type.fixed_size is not None,
        not _LIMITS.isdisjoint(arguments),
        parameter.span,
    )


def _endpoints(expected: Sequence[End], actual: Sequence[End], choices: Choices) -> Iterator[Difference]:
    places = dict.fromkeys((end.category, end.name) for end in (*expected, *actual))
    for place in places:
        said = {end.type_name: end for end in expected if (end.category, end.name) == place}
        seen = {end.type_name: end for end in actual if (end.category, end.name) == place}
        gone = [end for name, end in said.items() if name not in seen]
        more = [end for name, end in seen.items() if name not in said]
        section = place[0].value
        if len(gone) == len(more) == 1:
            detail = f"{gone[0].type_name} is declared, but it is {more[0].type_name}"
            yield Difference("type_mismatch", section, place[1], detail, gone[0].span)
        else:
            for end in gone:
                yield Difference("missing", section, end.name, f"there is none ({end.type_name})", end.span)
            for end in more:
                yield Difference("extra", section, end.name, f"it is not declared ({end.type_name})")
        for name, end in said.items():
            if name in seen:
                yield from _of_one(end, seen[name], choices)


def _of_one(said: End, seen: End, choices: Choices) -> Iterator[Difference]:
    """The differences of an endpoint that both have with the same type."""
    section, name, span = said.category.value, said.name, said.span
    if said.type_hash and seen.type_hash == "":
        yield Difference("unverifiable", section, name, "its type hash is unknown", span)
    elif said.type_hash and seen.type_hash and said.type_hash != seen.type_hash:
        detail = f"{said.type_name} is {said.type_hash} here, but the node has {seen.type_hash}"
        yield Difference("hash_mismatch", section, name, detail, span)
    for type_name, type_hash in seen.parts.items():
        if type_hash and said.parts.get(type_name, type_hash) != type_hash:
            detail = f"{type_name} is {said.parts[type_name]} here, but the node has {type_hash}"
            yield Difference("hash_mismatch", section, name, detail, span)
    if said.qos is None:
        return
    place = said.qos.span or span
    if seen.qos is None:
        yield Difference("unverifiable", section, name, "its QoS cannot be seen", place)
        return
    if choices.compatible:
        offers = said.category is Category.PUBLISHER
        offered, requested = (seen.qos, said.qos) if offers else (said.qos, seen.qos)
        if reason := qos_mismatch(offered, requested):
            yield Difference("qos_mismatch", section, name, reason, place)
        return
    for kind, detail in _policies(said.qos, seen.qos):
        yield Difference(kind, section, name, detail, place)


def _policies(said: QosProfile, seen: QosProfile) -> Iterator[tuple[Kind, str]]:
    for policy in _POLICIES:
        wanted, found = getattr(said, policy), getattr(seen, policy)
        if wanted in _OPEN or wanted == found:
            continue
        if found in _OPEN:
            yield "unverifiable", f"{policy} {wanted} is declared, but it is unknown"
        else:
            yield "qos_mismatch", f"{policy} {wanted} is declared, but it is {found}"
    if said.history == seen.history == "KEEP_LAST" and said.depth != seen.depth:
        if seen.depth:
            yield "qos_mismatch", f"depth {said.depth} is declared, but it is {seen.depth}"
        else:
            yield "unverifiable", f"depth {said.depth} is declared, but it is unknown"
    for duration in _DURATIONS:
        wanted, found = getattr(said, duration), getattr(seen, duration)
        if wanted not in {0, found}:
            shown = f"{found}" if found else "unlimited"
            yield "qos_mismatch", f"{duration} {wanted} is declared, but it is {shown}"


def _parameters(expected: Sequence[Value], actual: Sequence[Value], choices: Choices) -> Iterator[Difference]:
    seen = {value.name: value for value in actual}
    for said in expected:
        found = seen.pop(said.name, None)
        if found is None:
            # A parameter without a value is not declared by rclpy.
            if said.type != "none":
                yield Difference("missing", _PARAMETERS, said.name, "the node does not have it", said.span)
            continue
        for kind, detail in _of_parameter(said, found, choices):
            yield Difference(kind, _PARAMETERS, said.name, detail, said.span)
    for found in seen.values():
        yield Difference("extra", _PARAMETERS, found.name, f"it is not declared ({found.type})")


def _of_parameter(said: Value, seen: Value, choices: Choices) -> Iterator[tuple[Kind, str]]:
    plain = re.sub(r"_fixed_\d+$", "", said.type)
    if said.type != seen.type:
        if seen.type == "none":
            yield "unverifiable", f"{said.type} is declared, but it has no value"
            return
        if plain != seen.type:
            yield "type_mismatch", f"{said.type} is declared, but it is {seen.type}"
            return
        yield "unverifiable", f"{said.type} is declared; its size cannot be seen"
    if said.read_only != seen.read_only:
        words = {True: "read-only", False: "to be set at any time"}
        yield (
            "property_mismatch",
            f"read_only: {words[said.read_only]} is declared, but it is {words[seen.read_only]}",
        )
    if said.bounds != seen.bounds and not (said.is_limited and said.bounds is None):
        yield "property_mismatch", f"bounds: {_range(said)} declared, but there is {_range(seen)}"
    if choices.defaults and said.default is not None and not _is_same(said.default, seen.default):
        yield "property_mismatch", f"default_value: {said.default!r} is declared, but it is {seen.default!r}"


def _range(value: Value) -> str:
    return f"[{value.bounds[0]:g}, {value.bounds[1]:g}]" if value.bounds else "no range"


def _is_same(first: Any, second: Any) -> bool:
    if isinstance(first, list) and isinstance(second, list):
        return len(first) == len(second) and all(map(_is_same, first, second))
    if isinstance(first, float) and isinstance(second, float) and math.isnan(first):
        return math.isnan(second)
    return bool(first == second) and isinstance(first, bool) == isinstance(second, bool)


def _ignore_rule(text: str) -> tuple[str, str, str]:
    """The list, the name and the type of `KIND:NAME[:TYPE]`."""
    kinds = {section.removesuffix("s"): section for section in _SECTIONS}
    match = _IGNORE.fullmatch(text)
    if match and match["kind"] in kinds:
        section, name, type_ = kinds[match["kind"]], match["name"], match["type"]
        if type_ is None if section == _PARAMETERS else name[0] in "/*":
            return section, name, type_ or "*"
    message = f"`{text}` says nothing to ignore"
    help = (
        "write KIND:NAME or KIND:NAME:TYPE, such as `publisher:/diagnostics`; the kinds are "
        f"{', '.join(kinds)}, and the name of an endpoint begins with / or *"
    )
    raise UsageError([Diagnostic("invalid-rule", message, help=help)])


def _is_ignored(found: Difference, rule: tuple[str, str, str], types: Mapping[tuple[str, str], str]) -> bool:
    section, name, type_ = rule
    if found.kind != "extra" or found.section != section or not fnmatchcase(found.name, name):
        return False
    return fnmatchcase(types.get((section, found.name), ""), type_)
