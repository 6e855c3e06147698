"""Questions about a model that generators of several languages ask."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ifgen.model import Interface, Message, Model, Step


def needed_interfaces(model: Model) -> list[Interface]:
    """The interfaces to generate, and those that the code of these refers to."""
    interfaces = {interface.id: interface for package in model.packages for interface in package.interfaces}
    owners = {message.type_name: message.interface for message in model.types}
    needed: set[str] = set()
    pending = [interface.id for interface in interfaces.values() if interface.generate]
    while pending:
        if (name := pending.pop()) not in needed:
            needed.add(name)
            pending += (owners[of] for message in interfaces[name].types for of in message.dependencies)
    return [interface for interface in interfaces.values() if interface.id in needed]


def called_messages(types: Mapping[str, Message]) -> set[str]:
    """The types of messages that others call as a part: those that are large, and all messages in them."""
    called: set[str] = set()

    def visit(steps: Iterable[Step]) -> None:
        for step in steps:
            if step.kind == "call" and step.type_name is not None and step.type_name not in called:
                called.add(step.type_name)
                visit(types[step.type_name].wire.own)
            visit(step.steps)

    for message in types.values():
        visit(message.wire.steps)
    return called
