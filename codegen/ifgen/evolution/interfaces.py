"""Compares two versions of packages: which interfaces there are, and what each of their messages holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ifgen.definition.interfaces import Action, Interface, Message, Registry, Service
from ifgen.definition.types import Array, BoundedSequence, FieldType, NamespacedType, UnboundedSequence
from ifgen.evolution.edits import InterfaceAdded, InterfaceEdit, InterfaceRemoved, InterfaceRenamed, Versions


def written_parts(interface: Interface) -> tuple[Message, ...]:
    """The messages that a person wrote: the others of a service or an action are derived from them."""
    match interface:
        case Message():
            return (interface,)
        case Service():
            return (interface.request, interface.response)
        case Action():
            return (interface.goal, interface.result, interface.feedback)


def versions(old: Interface, new: Interface) -> Iterator[Versions]:
    """The parts of an interface in both versions. Both are of one kind."""
    for before, after in zip(written_parts(old), written_parts(new), strict=True):
        yield Versions(before, after)


def matched(
    old: Mapping[str, Interface], new: Mapping[str, Interface], old_registry: Registry, new_registry: Registry
) -> tuple[list[tuple[Interface, Interface]], list[InterfaceEdit]]:
    """The interfaces that both versions have, side by side, and the edits of those that only one has."""
    gone = [interface for name, interface in old.items() if name not in new]
    come = [interface for name, interface in new.items() if name not in old]
    renamed = _renamed(gone, come, old_registry, new_registry) if gone and come else []
    moved = {id(interface) for pair in renamed for interface in pair}
    edits: list[InterfaceEdit] = [InterfaceRenamed(before, after) for before, after in renamed]
    edits += (InterfaceRemoved(interface) for interface in gone if id(interface) not in moved)
    edits += (InterfaceAdded(interface) for interface in come if id(interface) not in moved)
    both = [(old[name], interface) for name, interface in new.items() if name in old]
    return both, edits


def _renamed(
    gone: Sequence[Interface], come: Sequence[Interface], old: Registry, new: Registry
) -> list[tuple[Interface, Interface]]:
    """The interfaces that have another name and the same contents: each one that stands for one other."""
    before, after = _by_contents(gone, old), _by_contents(come, new)
    pairs: list[tuple[Interface, Interface]] = []
    for contents, were in before.items():
        are = after.get(contents, [])
        for key in (lambda i: (i.folder, i.name), lambda i: (i.package, i.folder), lambda i: i.folder):
            for interface in list(were):
                same = [other for other in are if key(other) == key(interface)]
                rivals = [other for other in were if key(other) == key(interface)]
                if len(same) == len(rivals) == 1:
                    pairs.append((interface, same[0]))
                    were.remove(interface)
                    are.remove(same[0])
    return pairs


def _by_contents(interfaces: Iterable[Interface], registry: Registry) -> dict[object, list[Interface]]:
    found: dict[object, list[Interface]] = {}
    known: dict[str, object] = {}
    for interface in interfaces:
        parts = tuple(_contents(part, registry, known) for part in written_parts(interface))
        found.setdefault((interface.folder, parts), []).append(interface)
    return found


def _contents(message: Message, registry: Registry, known: dict[str, object]) -> object:
    """All that a message holds, without the name of any type."""
    name = message.type_name
    if name not in known:
        fields = tuple(
            (f.name, repr(f.default_value), _held(f.type, registry, known)) for f in message.fields
        )
        constants = frozenset((c.name, c.type, repr(c.value)) for c in message.constants)
        known[name] = (fields, constants)
    return known[name]


def _held(type_: FieldType, registry: Registry, known: dict[str, object]) -> object:
    match type_:
        case NamespacedType():
            return _contents(registry.message(type_.type_name), registry, known)
        case Array(value_type, size):
            return ("array", size, _held(value_type, registry, known))
        case BoundedSequence(value_type, size):
            return ("sequence", size, _held(value_type, registry, known))
        case UnboundedSequence(value_type):
            return ("sequence", None, _held(value_type, registry, known))
        case _:
            return type_
