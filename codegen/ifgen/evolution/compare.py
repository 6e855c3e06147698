"""Compares two versions of a project: everything that differs, and where else it is felt."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from ifgen.definition.interfaces import Field, Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.definition.types import Array, BoundedSequence, FieldType, NamespacedType, UnboundedSequence
from ifgen.evolution import nodes
from ifgen.evolution.edits import (
    Edit,
    InterfaceAdded,
    InterfaceEdit,
    InterfaceRemoved,
    InterfaceRenamed,
    NodeRemoved,
    PackageRemoved,
    Versions,
)
from ifgen.evolution.lock.text import written_parts
from ifgen.evolution.messages import Comparison
from ifgen.evolution.values import Layouts
from ifgen.evolution.version import Version

_MAX_PATHS: Final = 50  # to one nested message: nobody reads more
_MAX_STEPS: Final = 20_000  # on the way to nested messages: definitions can hold each other in too many ways


@dataclass(frozen=True, slots=True)
class Path:
    """The way from a message that is compared to one that it holds: `robot_msgs/State.pose.covariance`."""

    message: Message
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Difference:
    """An edit. `paths` lead to its message from those of other interfaces, which it changes as well.

    `is_own` is false if the edit is in a package that is not compared: then it is felt in the paths only.
    """

    edit: Edit
    paths: tuple[Path, ...] = ()
    is_own: bool = True


def compare(old: Version, new: Version) -> list[Difference]:
    """Everything that differs between two versions."""
    return list(_Comparer(old, new).differences())


def between(
    old: Interface,
    new: Interface,
    old_registry: Registry,
    new_registry: Registry,
    *,
    with_constants: bool = True,
) -> Iterator[Difference]:
    """Everything that differs between two interfaces, whatever their names, and in what they hold."""
    if old.folder != new.folder:
        return
    name = {old.type_name: new.type_name}
    layouts = Layouts(old_registry), Layouts(new_registry)
    messages = Comparison(*layouts, lambda known: name.get(known, known), with_constants)
    seen: set[str] = set()

    def nested(version: Versions, top: Message, before: tuple[Field, ...]) -> Iterator[Difference]:
        for one, other in messages.pairs(version):
            if one is None or other is None or not messages.same_type(one.type, other.type):
                continue
            if not (held := _held(other)) or held in seen:
                continue
            seen.add(held)
            path = (*before, other)
            inner = Versions(old_registry.message(_held(one)), new_registry.message(held))
            for edit in messages.edits(inner):
                yield Difference(edit, (Path(top, path),), is_own=False)
            yield from nested(inner, top, path)

    for version in parts_of(old, new):
        yield from map(Difference, messages.edits(version))
        yield from nested(version, version.new, ())


class _Comparer:
    """Two versions, and the interfaces of both side by side."""

    def __init__(self, old: Version, new: Version) -> None:
        self._old, self._new = old, new
        in_old, in_new = old.interfaces, new.interfaces
        gone = {name: i for name, i in in_old.items() if not new.leaves_out(i)}
        come = {name: i for name, i in in_new.items() if not old.leaves_out(i)}
        self._both, self._edits = _matched(gone, come, old.registry, new.registry)
        names = {e.old.type_name: e.new.type_name for e in self._edits if isinstance(e, InterfaceRenamed)}
        self._renamed: Mapping[str, str] = names
        self._messages = Comparison(Layouts(old.registry), Layouts(new.registry), self._in_new)
        self._steps = 0
        self._own: dict[str, Versions] = {}
        for before, after in [
            *self._both,
            *((e.old, e.new) for e in self._edits if isinstance(e, InterfaceRenamed)),
        ]:
            for version in parts_of(before, after):
                self._own[version.new.type_name] = version

    def differences(self) -> Iterator[Difference]:
        """Own edits first, then those that come through other packages, then nodes."""
        lost, rest = self._lost_packages()
        yield from map(Difference, lost)
        edits = {name: list(self._messages.edits(version)) for name, version in self._own.items()}
        nested = {name: list(self._messages.edits(v)) for name, v in self._nested().items()}
        paths = self._paths({name for name, found in (edits | nested).items() if found})
        for edit in self._edits:
            if not isinstance(edit, InterfaceRemoved) or edit.interface.package in rest:
                yield Difference(edit)
        for name, found in edits.items():
            yield from (Difference(edit, paths.get(name, ())) for edit in found)
        for name, found in nested.items():
            if name in paths:
                yield from (Difference(edit, paths[name], is_own=False) for edit in found)
        if self._old.nodes is not None and self._new.nodes is not None:
            for change in nodes.compare(self._old.nodes, self._new.nodes, self._in_new):
                if not isinstance(change, NodeRemoved) or change.node.package in rest:
                    yield Difference(change)

    def _in_new(self, type_name: str) -> str:
        return self._renamed.get(type_name, type_name)

    def _lost_packages(self) -> tuple[list[PackageRemoved], set[str]]:
        """The packages of which nothing is left, and the names of all others."""
        removed: dict[str, list[Interface]] = {}
        for edit in self._edits:
            if isinstance(edit, InterfaceRemoved):
                removed.setdefault(edit.interface.package, []).append(edit.interface)
        lost: list[PackageRemoved] = []
        for name, declared in self._old.packages.items():
            if name in self._new.packages:
                continue
            gone = removed.get(name, [])
            nodes = [node for node in self._old.nodes or () if node.package == name]
            place = declared or next((found.span for found in (*gone, *nodes) if found.span), None)
            if gone or nodes:
                lost.append(PackageRemoved(name, len(gone), len(nodes), place))
        names = {package.name for package in lost}
        return lost, set(self._old.packages) - names

    def _nested(self) -> dict[str, Versions]:
        """The messages of other packages that both versions know."""
        found: dict[str, Versions] = {}
        for name, package in self._new.registry.packages.items():
            if name in self._new.packages:
                continue
            for interface in package.interfaces:
                before = self._old.registry.get(interface.type_name)
                is_known = isinstance(interface, Message) and isinstance(before, Message)
                if is_known and not {interface.type_name} & (self._old.broken | self._new.broken):
                    found[interface.type_name] = Versions(before, interface)  # type: ignore[arg-type]
        return found

    def _paths(self, edited: set[str]) -> dict[str, tuple[Path, ...]]:
        """The paths to edited messages, from the messages of the interfaces that both versions have."""
        holding = self._holding(edited)
        found: dict[str, list[Path]] = {}
        for version in self._own.values():
            for path in self._ways(version, holding, ()):
                last = path[-1]
                target = _held(last)
                if target in edited and len(of_target := found.setdefault(target, [])) < _MAX_PATHS:
                    of_target.append(Path(version.new, path))
        return {name: tuple(paths) for name, paths in found.items()}

    def _ways(
        self, version: Versions, holding: set[str], before: tuple[Field, ...]
    ) -> Iterator[tuple[Field, ...]]:
        """The paths of fields from a message to those that are edited, through fields of unchanged types."""
        if _holds_none(version.new, holding) or self._steps > _MAX_STEPS:
            return
        self._steps += 1
        for old, new in self._messages.pairs(version):
            if old is None or new is None or not self._messages.same_type(old.type, new.type):
                continue
            name = _held(new)
            if name not in holding:
                continue
            yield (*before, new)
            inner = Versions(self._old.registry.message(_held(old)), self._new.registry.message(name))
            yield from self._ways(inner, holding, (*before, new))

    def _holding(self, edited: set[str]) -> set[str]:
        """The messages that are edited, or hold one that is."""
        users: dict[str, list[str]] = {}
        for interface in self._new.registry:
            for part in (interface,) if isinstance(interface, Message) else interface.messages:
                for _, type_ in references(part):
                    users.setdefault(type_.type_name, []).append(part.type_name)
        holding: set[str] = set()
        pending = list(edited)
        while pending:
            name = pending.pop()
            if name not in holding:
                holding.add(name)
                pending += users.get(name, ())
        return holding


def _held(field: Field) -> str:
    """The name of the message that a field holds; empty if it holds none."""
    type_ = getattr(field.type, "value_type", field.type)
    return getattr(type_, "type_name", "")


def _holds_none(message: Message, holding: set[str]) -> bool:
    return all(type_.type_name not in holding for _, type_ in references(message))


def parts_of(old: Interface, new: Interface) -> Iterator[Versions]:
    """The parts of an interface in both versions. Both are of one kind."""
    for before, after in zip(written_parts(old), written_parts(new), strict=True):
        yield Versions(before, after)


def _matched(
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
            (f.name, repr(f.default_value), _held_contents(f.type, registry, known)) for f in message.fields
        )
        constants = frozenset((c.name, c.type, repr(c.value)) for c in message.constants)
        known[name] = (fields, constants)
    return known[name]


def _held_contents(type_: FieldType, registry: Registry, known: dict[str, object]) -> object:
    match type_:
        case NamespacedType():
            return _contents(registry.message(type_.type_name), registry, known)
        case Array(value_type, size):
            return ("array", size, _held_contents(value_type, registry, known))
        case BoundedSequence(value_type, size):
            return ("sequence", size, _held_contents(value_type, registry, known))
        case UnboundedSequence(value_type):
            return ("sequence", None, _held_contents(value_type, registry, known))
        case _:
            return type_
