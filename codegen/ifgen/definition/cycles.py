"""Messages that contain themselves, directly or through others: no code can hold them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.references import references, type_span
from ifgen.diagnostics import Diagnostic, Label

_MAX_LINKS = 10


def check_cycles(messages: Mapping[str, Message]) -> list[Diagnostic]:
    """One finding for each circle of messages that a walk over all of them runs into."""
    found: list[Diagnostic] = []
    done: set[str] = set()
    for root in messages:
        if root not in done:
            found.extend(_describe(cycle) for cycle in _cycles_from(root, messages, done))
    return found


def _cycles_from(
    root: str, messages: Mapping[str, Message], done: set[str]
) -> Iterator[list[tuple[Message, Field]]]:
    """Walk depth first, on a stack of our own since chains may be long; yield the links of each circle."""
    path: list[tuple[Message, Field]] = []
    depth = {root: 0}
    pending = [(messages[root], references(messages[root]))]
    while pending:
        message, remaining = pending[-1]
        field, type_ = next(remaining, (None, None))
        if field is None or type_ is None:
            pending.pop()
            done.add(message.type_name)
            del depth[message.type_name]
            if path:
                path.pop()
            continue
        name = type_.type_name
        if name in depth:
            yield [*path[depth[name] :], (message, field)]
        elif name not in done and name in messages:
            depth[name] = len(pending)
            path.append((message, field))
            pending.append((messages[name], references(messages[name])))


def _describe(links: list[tuple[Message, Field]]) -> Diagnostic:
    first, *others = links
    labels = [_label(message, field) for message, field in (first, *others[: _MAX_LINKS - 1])]
    known = [label for label in labels if label is not None]
    circle = " -> ".join(message.type_name for message, _ in [*links[:_MAX_LINKS], first])
    return Diagnostic(
        "recursive-type",
        f"{first[0].type_name} contains itself",
        known[0] if known else None,
        tuple(known[1:]),
        f"the cycle is {circle}; messages cannot be recursive, not even through a sequence",
    )


def _label(message: Message, field: Field) -> Label | None:
    span = type_span(field)
    return Label(span, f"{message.type_name} holds this") if span else None
