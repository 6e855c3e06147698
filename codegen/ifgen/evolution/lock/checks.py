"""Checks that the definitions in a lock file belong together: types that are there, and hashes that fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from ifgen.definition import derive
from ifgen.definition.impossible import check_cycles
from ifgen.definition.interfaces import Action, Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.definition.type_description import TypeHashes, referenced_types
from ifgen.diagnostics import Diagnostic, InputError, Label, Span
from ifgen.evolution.lock.text import written_parts

AGAIN: Final = "run `ifgen lock` again; it does not read this file"
"""The advice about a lock file with a mistake."""


def invalid(span: Span | None, message: str, help: str = AGAIN, label: str = "") -> Diagnostic:
    """A mistake in a lock file."""
    return Diagnostic("invalid-lock", message, Label(span, label) if span else None, help=help)


def check(registry: Registry, hashes: Mapping[str, tuple[str, Span]]) -> None:
    """Raise InputError with the first mistake; `hashes` are those in the file, with their places."""
    messages = {part.type_name: part for interface in registry for part in _messages(interface)}
    missing = next(_missing(registry, messages), None)
    if missing is not None:
        raise InputError([missing])
    for cycle in check_cycles(messages):
        raise InputError([invalid(cycle.primary.span if cycle.primary else None, cycle.message)])
    _check_hashes(registry, hashes)


def _messages(interface: Interface) -> tuple[Message, ...]:
    return (interface,) if isinstance(interface, Message) else interface.messages


def _missing(registry: Registry, messages: Mapping[str, Message]) -> Iterator[Diagnostic]:
    """The types that are needed, and not in the file."""
    for message in messages.values():
        for field, type_ in references(message):
            if type_.type_name not in messages:
                text = f"{message.type_name} needs {type_.type_name}, which is not in the file"
                yield invalid(field.type_span or message.span, text)
    for interface in registry:
        for support in derive.ACTION_SUPPORT if isinstance(interface, Action) else ():
            name = "/".join(support)
            if registry.get(name) is None:
                yield invalid(interface.span, f"{interface.type_name} needs {name}, which is not in the file")


def _check_hashes(registry: Registry, hashes: Mapping[str, tuple[str, Span]]) -> None:
    """Report a hash that does not fit: the one of the smallest type, because others contain that."""
    computed = TypeHashes(registry)
    described = (item for interface in registry for item in (*written_parts(interface), interface))
    wrong = [item for item in described if computed.of(item) != hashes[item.type_name][0]]
    if wrong:
        edited = min(wrong, key=lambda item: len(referenced_types(item, registry)))
        message = f"the hash of {edited.type_name} does not fit its definition here"
        label = f"the definition has the hash {computed.of(edited)}"
        span = hashes[edited.type_name][1]
        raise InputError([invalid(span, message, f"somebody edited the file; {AGAIN}", label)])
