"""Compares the interfaces of a project with its lock file, field by field, with the places on both sides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from operator import eq
from typing import Final

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, InputError, Label, Span
from ifgen.evolution.lock.file import Lock
from ifgen.evolution.lock.text import NAME, definition_text, definitions, written_parts
from ifgen.evolution.messages import paired_constants, paired_fields

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
    """The differences between two versions of a message: fields, constants, then the order of fields."""
    if list(definitions(old)) == list(definitions(new)):
        return
    fields = paired_fields(old.fields, new.fields, eq)
    for before, after in (*fields, *paired_constants(old.constants, new.constants)):
        was, now = (item and definition_text(item) for item in (before, after))
        if before is None and after is not None:
            message = f"{new.type_name}: `{now}` is not in {NAME}"
            yield _difference(message, _label(after.span, "this is new"), _place(old))
        elif after is None and before is not None:
            message = f"{new.type_name}: `{was}` is gone"
            yield _difference(message, _whole(new), _label(before.span, "this is locked"))
        elif before is not None and after is not None and was != now:
            places = _label(after.span, "this is new"), _label(before.span, "this is locked")
            yield _difference(f"{new.type_name}: `{now}` was `{was}`", *places)
    yield from _moved(old, new)


def _moved(old: Message, new: Message) -> Iterator[Diagnostic]:
    """The first field that has another place, if the fields are the same ones in another order."""
    before, after = ([field.name for field in message.fields] for message in (old, new))
    if before == after or sorted(before) != sorted(after):
        return
    first = next(place for place, name in enumerate(after) if name != before[place])
    was, now = old.fields[first], new.fields[first]
    message = f"{new.type_name}: the field '{now.name}' is now where '{was.name}' was"
    yield _difference(message, _label(now.span, "this is new"), _label(was.span, "this is locked"))


def _difference(message: str, primary: Label | None, secondary: Label | None = None) -> Diagnostic:
    return Diagnostic("lock-mismatch", message, primary, (secondary,) if secondary else (), _HELP)


def _label(span: Span | None, text: str) -> Label | None:
    return Label(span, text) if span else None


def _place(message: Message) -> Label | None:
    return _label(message.span, "this is locked")


def _whole(interface: Interface) -> Label | None:
    return Label(Span(interface.source, 0, 0)) if interface.source else None
