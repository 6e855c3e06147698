"""The types of fields as message classes spell them: `double`, `sequence<uint8, 5>`, `std_msgs/Header[3]`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Final

_ARRAY: Final = re.compile(r"(?P<element>.+)\[(?P<size>\d+)\]")
_SEQUENCE: Final = re.compile(r"sequence<(?P<element>.+?)(, (?P<size>\d+))?>")
_BOUND: Final = re.compile(r"<(\d+)>")

INTEGERS: Final = {
    f"{prefix}int{bits}": (0, 2**bits - 1) if prefix else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for prefix in ("", "u")
    for bits in (8, 16, 32, 64)
}
"""The lowest and the highest value of each type of integer."""


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field: that of one element, and how many there are.

    `element` is such as `double`, `string` or `geometry_msgs/msg/Point`. `size` is the number of elements of
    an array, the bound of a sequence, or None. `attribute` is the name of the field in Python. `longest` is
    the bound of a string in characters.
    """

    element: str
    attribute: str
    is_array: bool = False
    is_sequence: bool = False
    size: int | None = None
    longest: int | None = None

    @property
    def is_message(self) -> bool:
        """Whether elements are messages."""
        return "/" in self.element

    @property
    def is_collection(self) -> bool:
        """Whether there may be several elements."""
        return self.is_array or self.is_sequence


def field_types(cls: type[Any]) -> dict[str, FieldType]:
    """The fields of a message class in their order."""
    found = _known.get(cls)
    if found is None:
        renamed: dict[str, str] = getattr(cls, "__renamed__", {})
        spelled: dict[str, str] = cls.get_fields_and_field_types()
        folder = cls.__module__.split(".")[1]
        found = {name: _read(text, renamed.get(name, name), folder) for name, text in spelled.items()}
        _known[cls] = found
    return found


_known: Final[dict[type[Any], dict[str, FieldType]]] = {}


def type_name(cls: type[Any]) -> str:
    """The name of a message class: `std_msgs/msg/String`."""
    package, kind = cls.__module__.split(".")[:2]
    known: str = getattr(cls, "__type_name__", f"{package}/{kind}/{cls.__name__}")
    return known


def element_class(message: Any, name: str) -> type[Any]:
    """The class of the messages in a field."""
    found = field_types(type(message))[name]
    value = getattr(message, found.attribute)
    if not found.is_collection:
        return type(value)
    if len(value):
        return type(value[0])
    from ifgen_runtime.field_types import fields_of  # only messages in lists need it

    try:
        [own] = [field.type for field in fields_of(type(message)) if field.name == name]
    except TypeError:  # a class of a real ROS
        package, kind, short = found.element.split("/")
        own = getattr(import_module(f"{package}.{kind}"), short)
    assert isinstance(own, type)
    return own


def _read(text: str, attribute: str, folder: str) -> FieldType:
    bound = _BOUND.search(text)
    longest = int(bound[1]) if bound else None
    if match := _ARRAY.fullmatch(text):
        size: int | None = int(match["size"])
        return FieldType(
            _element(match["element"], folder), attribute, is_array=True, size=size, longest=longest
        )
    if match := _SEQUENCE.fullmatch(text):
        size = int(match["size"]) if match["size"] else None
        return FieldType(
            _element(match["element"], folder), attribute, is_sequence=True, size=size, longest=longest
        )
    return FieldType(_element(text, folder), attribute, longest=longest)


def _element(text: str, folder: str) -> str:
    """The type without the bound of a string, and a message with its folder.

    That is `msg`, or for a part of a service or an action, such as `Add_Request`, that of its neighbours.
    """
    package, slash, short = _BOUND.sub("", text).partition("/")
    if not slash or "/" in short:
        return f"{package}{slash}{short}"
    return f"{package}/{folder if '_' in short else 'msg'}/{short}"
