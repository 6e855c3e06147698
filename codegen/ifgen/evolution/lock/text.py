"""The text of a lock file: sorted, a line for each field, and always the same for the same interfaces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from ifgen.definition.interfaces import Action, Constant, Field, Interface, Message, Registry, Service
from ifgen.definition.type_description import TypeHashes
from ifgen.evolution.lock.notation import type_text, value_text

NAME: Final = "ifgen.lock"
"""The name of a lock file; it is beside pyproject.toml."""

VERSION: Final = 1
"""The version of the format."""

END: Final = "end"
"""The last line: a file without it was cut off."""

_HEAD: Final = f"""\
# The interfaces of this project and of the packages that it needs, with their type hashes.
# `ifgen lock` writes this file and `ifgen generate --locked` keeps to it. Do not edit it.
version {VERSION}
"""


def text(registries: Iterable[Registry]) -> str:
    """The lock file for all interfaces in these registries."""
    blocks: dict[str, str] = {}
    for registry in registries:
        hashes = TypeHashes(registry)
        for interface in registry:
            if interface.type_name not in blocks:
                blocks[interface.type_name] = _block(interface, hashes)
    return "\n".join((_HEAD, *(blocks[name] for name in sorted(blocks)), f"{END}\n"))


def written_parts(interface: Interface) -> tuple[Message, ...]:
    """The messages that a person wrote: the others of a service or an action are derived from them."""
    match interface:
        case Message():
            return (interface,)
        case Service():
            return (interface.request, interface.response)
        case Action():
            return (interface.goal, interface.result, interface.feedback)


def definitions(message: Message) -> Iterator[Field | Constant]:
    """The fields of a message, then its constants."""
    yield from message.fields
    yield from message.constants


def definition_text(item: Field | Constant) -> str:
    """A field or a constant as a lock file writes it, in the form of .msg files."""
    text = f"{type_text(item.type)} {item.name}"
    if isinstance(item, Constant):
        return f"{text}={value_text(item.value, item.type)}"
    return text if item.default_value is None else f"{text} {value_text(item.default_value, item.type)}"


def _block(interface: Interface, hashes: TypeHashes) -> str:
    lines = [f"{interface.type_name} {hashes.of(interface)}"]
    for part in written_parts(interface):
        if part is not interface:
            lines.append(f"  {part.name} {hashes.of(part)}")
        lines += (f"    {definition_text(item)}" for item in definitions(part))
    return "\n".join(lines) + "\n"
