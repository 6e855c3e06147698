"""The text of a lock file: sorted, a line for each field, and always the same for the same interfaces.

The notation is that of .msg files, with two differences. Types of messages always name their package, and
their folder where it is not `msg`. Values are JSON, because any string has one spelling there. `char` is the
character of an .idl file; the `char` of a .msg file is a `uint8`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Final

from ifgen.definition import names
from ifgen.definition.described.values import Value, from_plain, plain
from ifgen.definition.interfaces import Action, Constant, Field, Interface, Message, Registry, Service
from ifgen.definition.literals import BadValue
from ifgen.definition.spelling import PRIMITIVES, spelled
from ifgen.definition.type_description import TypeHashes
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    ValueType,
)
from ifgen.reading.packages import FOLDERS

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


_PRIMITIVES: Final[dict[str, ValueType]] = {**PRIMITIVES, "char": BasicType("char")}
_TYPE: Final = re.compile(
    r"(?P<base>[A-Za-z][A-Za-z0-9_/]*)(?:<=(?P<bound>[1-9][0-9]{0,19}))?"
    r"(?:\[(?P<upto><=)?(?P<size>[1-9][0-9]{0,19})?\])?"
)


def type_text(type_: FieldType) -> str:
    """The text of a type."""
    if isinstance(type_, Array | BoundedSequence | UnboundedSequence):
        return type_text(type_.value_type) + spelled(type_)[len(spelled(type_.value_type)) :]
    if isinstance(type_, NamespacedType) and type_.folder != "msg":
        return type_.type_name
    return spelled(type_)


@lru_cache(maxsize=4096)
def read_type(text: str) -> FieldType | None:
    """The type that a text stands for; None if it is none. Whether a message exists is not looked at."""
    match = _TYPE.fullmatch(text)
    value_type = _value_type(match["base"], match["bound"]) if match else None
    if match is None or value_type is None or "[" not in text:
        return value_type
    if match["size"] is None:
        return None if match["upto"] else UnboundedSequence(value_type)
    return (BoundedSequence if match["upto"] else Array)(value_type, int(match["size"]))


def _value_type(base: str, bound: str | None) -> ValueType | None:
    if bound is not None:
        if base == "string":
            return BoundedString(int(bound))
        return BoundedWString(int(bound)) if base == "wstring" else None
    if base in _PRIMITIVES:
        return _PRIMITIVES[base]
    package, *folder, name = base.split("/") if "/" in base else ("", base)
    if len(folder) > 1 or not names.is_package_name(package) or not is_type_name(name):
        return None
    if folder and folder[0] not in FOLDERS:
        return None
    return NamespacedType(package, folder[0] if folder else "msg", name)


def is_type_name(name: str) -> bool:
    """Whether a message may have this name, in a .msg or an .idl file."""
    return names.is_message_name(name) or names.is_idl_type_name(name)


def value_text(value: Value, type_: FieldType) -> str:
    """The text of a constant's value or of a default, for a field or a constant of this type."""
    return json.dumps(plain(value, type_))


def read_value(text: str, type_: FieldType) -> Value:
    """The value that a text stands for in a field or a constant of this type. Raises BadValue."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise BadValue("expected a value in JSON") from None
    return from_plain(value, type_)
