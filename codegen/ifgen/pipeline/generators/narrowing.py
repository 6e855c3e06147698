"""The scope of a target: the elements that its patterns name, and that its generator can express."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase

from ifgen.generators import FEATURES, Generator
from ifgen.model import Field, Interface, Message, Model, Node, Package

_OF_ACTIONS = ("action_msgs/srv/CancelGoal", "action_msgs/msg/GoalStatusArray")


def wanted(model: Model, only: Iterable[str], *, with_deps: bool) -> set[str]:
    """The ids of the interfaces to generate."""
    patterns = tuple(only)
    chosen = {i.id for i in _interfaces(model) if i.generate and _matches(i.package, i.type_name, patterns)}
    return with_needed(model, chosen) if with_deps else chosen


def with_needed(model: Model, chosen: Iterable[str]) -> set[str]:
    """These interfaces, and all that they need."""
    interfaces = {i.id: i for i in _interfaces(model)}
    owners = {message.type_name: message.interface for message in model.types}
    found: set[str] = set()
    pending = list(chosen)
    while pending:
        name = pending.pop()
        if name not in found and name in interfaces:
            found.add(name)
            interface = interfaces[name]
            pending += (owners[of] for message in interface.types for of in message.dependencies)
            pending += _OF_ACTIONS if interface.kind == "action" else ()
    return found


def narrowed(model: Model, chosen: set[str], only: Iterable[str] = ()) -> Model:
    """The model in which these interfaces are to be generated, and no others."""
    patterns = tuple(only)
    types = {m.type_name: _marked(m, m.interface in chosen) for m in model.types}

    def interface(of: Interface) -> Interface:
        parts = tuple(types[message.type_name] for message in of.messages)
        own = tuple(types[message.type_name] for message in of.types)
        return replace(of, generate=of.id in chosen, messages=parts, types=own)

    def package(of: Package) -> Package:
        interfaces = tuple(map(interface, of.interfaces))
        nodes = tuple(node for node in of.nodes if _matches(of.name, _node_name(node), patterns))
        is_wanted = any(i.generate for i in interfaces) or bool(of.generate and nodes)
        return replace(of, interfaces=interfaces, nodes=nodes, generate=is_wanted)

    return replace(model, packages=tuple(map(package, model.packages)), types=tuple(types.values()))


def _marked(message: Message, generate: bool) -> Message:
    return message if message.generate == generate else replace(message, generate=generate)


def unmatched(model: Model, only: Iterable[str]) -> list[str]:
    """The patterns that match nothing."""
    names = [(i.package, i.type_name) for i in _interfaces(model) if i.generate]
    names += ((package.name, _node_name(node)) for package in model.packages for node in package.nodes)
    return [pattern for pattern in only if not any(_matches(*name, (pattern,)) for name in names)]


def lacking(model: Model, chosen: set[str], generator: Generator) -> Iterator[tuple[str, str, str]]:
    """All that a generator cannot express: an interface, the id of the element, and the feature in words."""
    if generator.features is None:
        return
    owners: Mapping[str, Interface] = {i.id: i for i in _interfaces(model)}
    for name in sorted(chosen):
        for id_, feature in _of_interface(owners[name]):
            if feature not in generator.features:
                yield name, id_, FEATURES[feature]


def _of_interface(interface: Interface) -> Iterator[tuple[str, str]]:
    if interface.kind != "message":
        yield interface.id, f"{interface.kind}s"
    for message in interface.messages:
        if message.placeholder:
            yield message.id, "empty"
        if message.constants:
            yield message.constants[0].id, "constants"
        for field in message.fields:
            yield from ((field.id, feature) for feature in _of_field(field))


def _of_field(field: Field) -> Iterator[str]:
    type_ = field.type
    if type_.primitive in {"wstring", "char"}:
        yield type_.primitive
    if type_.primitive in {"int64", "uint64"}:
        yield "int64"
    if type_.array is not None and type_.array.kind != "fixed":
        yield "sequences"
    is_text = type_.primitive in {"string", "wstring"}
    if is_text and type_.string_bound is not None:
        yield "bounded-strings"
    if (is_text and type_.string_bound is None) or (type_.array and type_.array.kind == "unbounded"):
        yield "unbounded"
    if field.default is not None:
        yield "defaults"


def _interfaces(model: Model) -> Iterator[Interface]:
    return (interface for package in model.packages for interface in package.interfaces)


def _node_name(node: Node) -> str:
    return f"{node.package}/nodl/{node.name}"


def _matches(package: str, name: str, patterns: tuple[str, ...]) -> bool:
    return not patterns or any(fnmatchcase(each, pattern) for pattern in patterns for each in (package, name))
