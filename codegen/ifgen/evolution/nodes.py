"""Compares two versions of nodes: their endpoints, QoS profiles and parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final, TypeVar

from ifgen.evolution import edits
from ifgen.evolution.values import Renamed
from ifgen.nodl.model import (
    Category,
    Endpoint,
    NodeDescription,
    Parameter,
    ParameterType,
    Validator,
    qos_mismatch,
)
from ifgen.nodl.names import expanded

T = TypeVar("T")
_TAKES_MORE_WITH: Final = {
    **dict.fromkeys(("gt", "gt_eq", "lower_element_bounds", "size_gt"), -1),
    **dict.fromkeys(("lt", "lt_eq", "upper_element_bounds", "size_lt"), 1),
}
"""Validators of one number, and the sign of a change of it with which they accept more."""


def compare(
    old: Iterable[NodeDescription], new: Iterable[NodeDescription], renamed: Renamed
) -> Iterator[edits.NodeEdit]:
    """The differences between the nodes of two versions.

    `renamed` maps the old name of an interface to the new one.
    """
    in_old, in_new = {(n.package, n.name): n for n in old}, {(n.package, n.name): n for n in new}
    gone = [node for key, node in in_old.items() if key not in in_new]
    come = [node for key, node in in_new.items() if key not in in_old]
    for before, after in _paired(gone, come, lambda node: (node.endpoints, node.parameters)):
        yield edits.NodeRenamed(before, after)
        gone.remove(before)
        come.remove(after)
    yield from map(edits.NodeRemoved, gone)
    yield from map(edits.NodeAdded, come)
    for key, node in in_new.items():
        if key in in_old:
            yield from _node(in_old[key], node, renamed)


def _node(old: NodeDescription, new: NodeDescription, renamed: Renamed) -> Iterator[edits.NodeEdit]:
    if (old.node_class, old.style) != (new.node_class, new.style):
        yield edits.NodeClassChanged(old, new)
    for category in Category:
        yield from _endpoints(
            new,
            [endpoint for endpoint in old.endpoints if endpoint.category is category],
            [endpoint for endpoint in new.endpoints if endpoint.category is category],
            renamed,
        )
    yield from _parameters(new, old.parameters, new.parameters)


def _endpoints(
    node: NodeDescription, old: Sequence[Endpoint], new: Sequence[Endpoint], renamed: Renamed
) -> Iterator[edits.NodeEdit]:
    in_old = {expanded(endpoint.name, node.name): endpoint for endpoint in old}
    in_new = {expanded(endpoint.name, node.name): endpoint for endpoint in new}
    gone = [endpoint for name, endpoint in in_old.items() if name not in in_new]
    come = [endpoint for name, endpoint in in_new.items() if name not in in_old]
    pairs = _paired(gone, come, lambda endpoint: endpoint.type_name)
    for before, after in pairs:
        yield edits.EndpointRenamed(node, before, after)
        gone.remove(before)
        come.remove(after)
    for endpoint in gone:
        yield edits.EndpointRemoved(node, endpoint)
    for endpoint in come:
        yield edits.EndpointAdded(node, endpoint)
    pairs += ((in_old[name], endpoint) for name, endpoint in in_new.items() if name in in_old)
    for before, after in pairs:
        if renamed(before.type_name) != after.type_name:
            yield edits.EndpointRetyped(node, before, after)
        elif before.qos != after.qos and before.qos is not None and after.qos is not None:
            yield edits.QosChanged(node, before, after, _mismatch(before, after))


def _mismatch(old: Endpoint, new: Endpoint) -> str | None:
    """The reason why a peer that has the old profile of this endpoint does not match the new one."""
    assert old.qos is not None
    assert new.qos is not None
    match new.category:
        case Category.PUBLISHER:
            return qos_mismatch(new.qos, old.qos)
        case Category.SUBSCRIPTION:
            return qos_mismatch(old.qos, new.qos)
        case _:  # a service sends and receives
            return qos_mismatch(new.qos, old.qos) or qos_mismatch(old.qos, new.qos)


def _parameters(
    node: NodeDescription, old: Sequence[Parameter], new: Sequence[Parameter]
) -> Iterator[edits.NodeEdit]:
    in_old, in_new = {p.name: p for p in old}, {p.name: p for p in new}
    gone = [parameter for parameter in old if parameter.name not in in_new]
    come = [parameter for parameter in new if parameter.name not in in_old]
    same = _paired(gone, come, lambda p: (p.type, repr(p.default), p.read_only, p.validators))
    for before, after in same:
        yield edits.ParameterRenamed(node, before, after)
        gone.remove(before)
        come.remove(after)
    for parameter in gone:
        yield edits.ParameterRemoved(node, parameter)
    for parameter in come:
        yield edits.ParameterAdded(node, parameter)
    for parameter in new:
        if parameter.name in in_old:
            yield from _parameter(node, in_old[parameter.name], parameter)


def _parameter(node: NodeDescription, old: Parameter, new: Parameter) -> Iterator[edits.NodeEdit]:
    if old.type != new.type:
        yield edits.ParameterRetyped(node, old, new, _takes_all_of_type(new.type, old.type))
    if old.type.base == new.type.base and repr(old.default) != repr(new.default):
        yield edits.ParameterDefaultChanged(node, old, new)
    if old.read_only != new.read_only:
        yield edits.ParameterAccessChanged(node, old, new)
    if set(old.validators) != set(new.validators):
        yield edits.ValidatorsChanged(node, old, new, _takes_all(new.validators, old.validators))


def _takes_all_of_type(new: ParameterType, old: ParameterType) -> bool:
    if (new.base, new.array) != (old.base, old.array):
        return False
    return new.fixed_size is None or (old.fixed_size is not None and old.fixed_size <= new.fixed_size)


def _takes_all(new: Sequence[Validator], old: Sequence[Validator]) -> bool:
    """Whether each value that the old validators accept is accepted by the new ones, as far as is evident."""
    return all(any(_is_wider(validator, other) for other in old) for validator in new)


def _is_wider(new: Validator, old: Validator) -> bool:
    if new == old:
        return True
    if new.name != old.name:
        return False
    match new.arguments, old.arguments:
        case ((int() | float() as after,), (int() | float() as before,)) if new.name in _TAKES_MORE_WITH:
            return (after - before) * _TAKES_MORE_WITH[new.name] >= 0
        case ((low, high), (lowest, highest)) if new.name in {"bounds", "element_bounds"}:
            numbers = (low, high, lowest, highest)
            return all(isinstance(n, int | float) for n in numbers) and low <= lowest and high >= highest  # type: ignore[operator]
        case (after, before) if new.name in {"one_of", "subset_of"}:
            return set(before) <= set(after)
        case _:
            return False


def _paired(gone: Sequence[T], come: Sequence[T], contents: Callable[[T], object]) -> list[tuple[T, T]]:
    """Those that are gone, each with the only one that came and has the same contents."""
    pairs: list[tuple[T, T]] = []
    for before in gone:
        were = [other for other in gone if contents(other) == contents(before)]
        are = [other for other in come if contents(other) == contents(before)]
        if len(were) == len(are) == 1:
            pairs.append((before, are[0]))
    return pairs
