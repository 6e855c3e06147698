"""Compares two versions of packages: which interfaces there are, and what each of their messages holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.types import Array, BoundedSequence, FieldType, NamespacedType, UnboundedSequence
from ifgen.evolution.edits import InterfaceAdded, InterfaceEdit, InterfaceRemoved, InterfaceRenamed, Versions
from ifgen.evolution.lock.text import written_parts


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
    """The interfaces with the same contents in another package, or under another name in the same one.

    Each is the only one that can have become the other.
    """
    before, after = _by_contents(gone, old), _by_contents(come, new)
    pairs: list[tuple[Interface, Interface]] = []
    for contents, were in before.items():
        are = after.get(contents, [])
        for is_alike in (_has_same_name, _is_in_same_package):
            for interface in list(were):
                same = [other for other in are if is_alike(other, interface)]
                rivals = [other for other in were if is_alike(other, interface)]
                if len(same) == len(rivals) == 1:
                    pairs.append((interface, same[0]))
                    were.remove(interface)
                    are.remove(same[0])
    return pairs


def _has_same_name(one: Interface, other: Interface) -> bool:
    return one.name == other.name


def _is_in_same_package(one: Interface, other: Interface) -> bool:
    return one.package == other.package


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
