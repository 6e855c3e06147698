"""Compares the interfaces of a project with its lock file, field by field, with the places on both sides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, InputError, Label, Span
from ifgen.evolution.lock_file import Lock
from ifgen.evolution.lock_text import NAME, definition_text, definitions, written_parts

_HELP: Final = f"read `ifgen breaking --against {NAME}`; if this is intended, run `ifgen lock` again"


def check(lock: Lock, registries: Iterable[Registry]) -> None:
    """Raise InputError unless the interfaces of these registries are the ones in the lock file.

    An interface that is only in the lock file is a difference if all of its package was asked for.
    """
    found = list(_differences(lock, list(registries)))
    if len(found) > MAX_PROBLEMS:
        more = f"and {len(found) - MAX_PROBLEMS} more differences from {NAME}"
        found = [*found[:MAX_PROBLEMS], Diagnostic("more-errors", more, help=_HELP)]
    if found:
        raise InputError(found)


def _differences(lock: Lock, registries: list[Registry]) -> Iterator[Diagnostic]:
    current = {interface.type_name: interface for registry in registries for interface in registry}
    for name, interface in sorted(current.items()):
        locked = lock.registry.get(name)
        if locked is None:
            yield _difference(f"{name} is not in {NAME}", _whole(interface))
        else:
            for old, new in zip(written_parts(locked), written_parts(interface), strict=True):
                yield from _changes(old, new)
    whole = {
        name for registry in registries for name in registry.requested if registry.packages[name].complete
    }
    for locked in lock.registry:
        if locked.type_name not in current and locked.package in whole:
            label = Label(locked.span) if locked.span else None
            yield _difference(f"{locked.type_name} is in {NAME}, and no longer exists", label)


def _changes(old: Message, new: Message) -> Iterator[Diagnostic]:
    """The differences between two versions of a message, in the order of the new one."""
    before, after = _texts(old), _texts(new)
    if before == after:
        return
    gone = {name: place for name, place in before.items() if name not in after}
    for name, (text, span) in after.items():
        if name not in before:
            yield from _added(name, text, span, gone, old, new)
        elif before[name][0] != text:
            was, place = before[name]
            message = f"{new.type_name}: `{text}` was `{was}`"
            yield _difference(message, _label(span, "this is new"), _label(place, "this is locked"))
    for text, place in gone.values():
        message = f"{new.type_name}: `{text}` is gone"
        yield _difference(message, _whole(new), _label(place, "this is locked"))
    yield from _moved(old, new)


def _added(
    name: str,
    text: str,
    span: Span | None,
    gone: dict[str, tuple[str, Span | None]],
    old: Message,
    new: Message,
) -> Iterator[Diagnostic]:
    """A definition that is new, or one that has another name at the same place: that one is not `gone`."""
    was = _renamed(name, old, new)
    if was is not None and was in gone:
        before, place = gone.pop(was)
        message = f"{new.type_name}: `{text}` was `{before}`"
        yield _difference(message, _label(span, "this is new"), _label(place, "this is locked"))
        return
    yield _difference(f"{new.type_name}: `{text}` is not in {NAME}", _label(span, "this is new"), _place(old))


def _renamed(name: str, old: Message, new: Message) -> str | None:
    """The former name of a field that has the place and the type of another one."""
    if len(old.fields) != len(new.fields):
        return None
    for before, after in zip(old.fields, new.fields, strict=True):
        if after.name == name:
            return before.name if before.type == after.type else None
    return None


def _moved(old: Message, new: Message) -> Iterator[Diagnostic]:
    """The first field that has another place, if the fields are the same ones in another order."""
    before, after = ([field.name for field in message.fields] for message in (old, new))
    if before == after or sorted(before) != sorted(after):
        return
    first = next(place for place, name in enumerate(after) if name != before[place])
    was, now = old.fields[first], new.fields[first]
    message = f"{new.type_name}: the field '{now.name}' is now where '{was.name}' was"
    yield _difference(message, _label(now.span, "this is new"), _label(was.span, "this is locked"))


def _texts(message: Message) -> dict[str, tuple[str, Span | None]]:
    """The fields and constants of a message by name, each as a lock file writes it, with its place."""
    return {item.name: (definition_text(item), item.span) for item in definitions(message)}


def _difference(message: str, primary: Label | None, secondary: Label | None = None) -> Diagnostic:
    return Diagnostic("lock-mismatch", message, primary, (secondary,) if secondary else (), _HELP)


def _label(span: Span | None, text: str) -> Label | None:
    return Label(span, text) if span else None


def _place(message: Message) -> Label | None:
    return _label(message.span, "this is locked")


def _whole(interface: Interface) -> Label | None:
    return Label(Span(interface.source, 0, 0)) if interface.source else None
