"""Literals, the order of structs, and names of headers, for the generators of both C and C++."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

from ifgen.model import FieldType, Interface, Message, Model, Package, Value

C_TYPES: Final = {
    "bool": "bool",
    "byte": "uint8_t",
    "char": "uint8_t",
    "float32": "float",
    "float64": "double",
    **{f"{sign}int{bits}": f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
"""The C types of primitives. A byte and a character are unsigned, as in rosidl."""

MAX_COUNT: Final = 2**31 - 1
"""The largest bound that has a chance to fit into memory."""

_SUFFIXES: Final = {"uint32": "U", "int64": "LL", "uint64": "ULL"}
_SMALLEST: Final = {"int64": -(2**63), "int32": -(2**31)}


def number(value: Value, type_: FieldType) -> str | None:
    """A boolean or a number; None for a float that has no literal, and for texts."""
    match type_.primitive:
        case "bool":
            return "true" if value.value else "false"
        case "float32" | "float64":
            text, suffix = value.exact, "f" if type_.primitive == "float32" else ""
            if text.lstrip("-") in {"inf", "nan"}:
                return None
            return text + (suffix if "." in text or "e" in text else f".0{suffix}")
        case "string" | "wstring":
            return None
        case primitive:
            digits, suffix = str(int(value.value)), _SUFFIXES.get(primitive, "")
            if int(digits) == _SMALLEST.get(
                primitive
            ):  # its digits, without the sign, are beyond the largest one
                return f"({int(digits) + 1}{suffix} - 1)"
            return digits + suffix


def string(text: str) -> str:
    """A string literal with the UTF-8 of the text."""
    return '"' + "".join(_escaped(byte) for byte in text.encode()) + '"'


def wide_string(text: str) -> str:
    """A UTF-16 string literal of C++."""
    return 'u"' + "".join(_wide(character) for character in text) + '"'


def _escaped(byte: int) -> str:
    character = chr(byte)
    if character in '"\\?':  # `??` may begin a trigraph
        return f"\\{character}"
    return character if 32 <= byte < 127 else f"\\{byte:03o}"


def _wide(character: str) -> str:
    code = ord(character)
    if code < 128:
        return _escaped(code)
    if code < 0xA0:  # no universal character name may say these
        return f"\\{code:03o}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def generated(model: Model) -> Iterator[Interface]:
    """The interfaces that are asked for."""
    for package in generated_packages(model):
        yield from package.interfaces


def generated_packages(model: Model) -> list[Package]:
    """The packages with interfaces that are asked for, and these alone."""
    packages = (
        replace(
            package, interfaces=tuple(interface for interface in package.interfaces if interface.generate)
        )
        for package in model.packages
    )
    return [package for package in packages if package.interfaces]


def needed(model: Model) -> list[Message]:
    """The messages that are asked for and all that these hold, each after those that it needs."""
    names = {message.type_name for message in model.types if message.generate}
    for message in reversed(model.types):
        if message.type_name in names:
            names.update(message.dependencies)
    return [message for message in model.types if message.type_name in names]


def path(interface: Interface, suffix: str) -> str:
    """The path of an interface's file, as rosidl has it: `sensor_msgs/msg/joint_state.hpp`."""
    return f"{interface.package}/{interface.folder}/{interface.snake_name}.{suffix}"


def includes(interface: Interface, suffix: str) -> list[str]:
    """The headers of the messages that an interface holds, sorted."""
    fields = (field for message in interface.types for field in message.fields)
    held = (field.type.message for field in fields if field.type.message)
    paths = {f"{each.package}/{each.folder}/{each.snake_interface}.{suffix}" for each in held}
    return sorted(paths - {path(interface, suffix)})


def guard(interface: Interface, suffix: str) -> list[str]:
    """Lines that refuse the header of rosidl that defines the same types."""
    macro = (
        f"{interface.package}__{interface.folder}__detail__{interface.snake_name}__struct_{suffix}_".upper()
    )
    words = f"{path(interface, suffix)} of rosidl and of ifgen cannot be in one program"
    return [f"#ifdef {macro}", f'#error "{words}: remove one from the include path"', "#endif", ""]


def in_order(types: Iterable[Message]) -> list[Message]:
    """The types of an interface, each after those of them that it holds."""
    own = {message.type_name: message for message in types}
    ordered: dict[str, Message] = {}

    def add(message: Message) -> None:
        for name in message.dependencies:
            if name in own and name not in ordered:
                add(own[name])
        ordered.setdefault(message.type_name, message)

    for message in own.values():
        add(message)
    return list(ordered.values())
