"""Questions about a model that generators of several languages ask."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping

from ifgen.generators import Finding
from ifgen.model import RESERVED, Interface, Message, Model, Step


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


def name_clashes(model: Model, language: str, members: Container[str] = ()) -> Iterator[Finding]:
    """Errors at fields and constants that would have one name in a language, such as `class_` beside `class`.

    `members` are the names in the scope of constants that the generated code has itself.
    """
    for message in model.types:
        for part in (message.package, message.name) if language in ("cpp", "rust") else ():
            if part in RESERVED[language]:  # they are namespaces and types; nothing but fields is renamed
                yield _clash(message.id, f"`{part}` in {message.type_name} is a keyword of {language}")
        for kind, elements in (("field", message.fields), ("constant", message.constants)):
            owners: dict[str, str] = {}
            for element in elements:
                name = element.names[language]
                owner = owners.setdefault(name, element.name)
                if owner != element.name:
                    words = f"the {kind} `{element.name}` has the name `{name}`, as `{owner}` has"
                    yield _clash(element.id, f"{words} in {language}")
                elif kind == "constant" and name in members:
                    words = f"the constant `{name}` has the name of something else in {language}"
                    yield _clash(element.id, words)


def _clash(element: str, message: str) -> Finding:
    return Finding(element, message, help="rename it, or the other one")
