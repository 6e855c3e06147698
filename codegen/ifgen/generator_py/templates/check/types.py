"""The types that the static check of templates knows, and what can be done with their values."""

from __future__ import annotations

import collections.abc
import enum
import types
import typing
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from typing import Any, Final, TypeAlias


@dataclass(frozen=True, slots=True)
class Anything:
    """A value that nothing is known about: everything can be done with it."""


@dataclass(frozen=True, slots=True)
class Plain:
    """A value of a class such as str, int or NoneType."""

    cls: type


@dataclass(frozen=True, slots=True)
class Record:
    """A value of a dataclass."""

    cls: type


@dataclass(frozen=True, slots=True)
class Many:
    """A tuple, list or other collection whose elements are of one type."""

    element: Type


@dataclass(frozen=True, slots=True)
class Group:
    """A tuple with an element of each of these types."""

    elements: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A mapping."""

    key: Type
    value: Type


@dataclass(frozen=True, slots=True)
class Either:
    """A value of one of several types."""

    members: frozenset[Type]


@dataclass(frozen=True, slots=True)
class Function:
    """A callable, and its result."""

    result: Type


@dataclass(frozen=True, slots=True)
class Names:
    """A value with known attributes only: an imported template, `loop`, `self`."""

    title: str
    attributes: tuple[tuple[str, Type], ...]


Type: TypeAlias = Any  # one of the above, or a macro (macros.py): a union cannot name itself here

ANYTHING: Final = Anything()
TEXT: Final = Plain(str)
NUMBER: Final = Plain(int)
TRUTH: Final = Plain(bool)
NOTHING: Final = Plain(type(None))

_LOOP: Final = {
    **dict.fromkeys(("index", "index0", "revindex", "revindex0", "length", "depth", "depth0"), NUMBER),
    **dict.fromkeys(("first", "last"), TRUTH),
    "cycle": Function(ANYTHING),
    "changed": Function(TRUTH),
}
_TEXT_METHODS: Final = {
    **dict.fromkeys(("split", "rsplit", "splitlines"), Many(TEXT)),
    **dict.fromkeys(("partition", "rpartition"), Group((TEXT, TEXT, TEXT))),
    **dict.fromkeys(("find", "rfind", "index", "rindex", "count"), NUMBER),
    **dict.fromkeys(("startswith", "endswith"), TRUTH),
    "encode": Plain(bytes),
}


def loop_over(element: Type) -> Names:
    """The variable `loop` of a loop over such elements."""
    attributes = {**_LOOP, "previtem": element, "nextitem": element}
    return Names("loop", tuple(attributes.items()))


def of_annotation(annotation: object) -> Type:
    """The type that an annotation stands for, in the form of `typing.get_type_hints`."""
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin in {typing.Union, types.UnionType}:
        return either(map(of_annotation, arguments))
    if origin is typing.Literal:
        return either(map(of_value, arguments))
    if origin is tuple:
        if len(arguments) == 2 and arguments[1] is Ellipsis:
            return Many(of_annotation(arguments[0]))
        return Group(tuple(map(of_annotation, arguments)))
    if origin in {collections.abc.Mapping, dict, types.MappingProxyType}:
        return Table(*map(of_annotation, arguments))
    if isinstance(origin, type) and issubclass(origin, collections.abc.Iterable) and len(arguments) == 1:
        return Many(of_annotation(arguments[0]))
    if annotation is None:
        return NOTHING
    if not isinstance(annotation, type) or annotation is object:
        return ANYTHING
    if is_dataclass(annotation):
        return Record(annotation)
    if issubclass(annotation, str | bytes | int | float | types.NoneType | enum.Enum):
        return Plain(annotation)
    return ANYTHING


def of_value(value: object) -> Type:
    """The type of a value that a template writes, or that stands in a file of filters."""
    cls: object = type(value)
    return of_annotation(cls) if not callable(value) else ANYTHING


def either(members: Iterable[Type]) -> Type:
    """A value of one of these types."""
    flat: set[Type] = set()
    for member in members:
        flat.update(member.members if isinstance(member, Either) else (member,))
    if ANYTHING in flat or not flat:
        return ANYTHING
    return flat.pop() if len(flat) == 1 else Either(frozenset(flat))


def members_of(type_: Type) -> tuple[Type, ...]:
    """The possible types of a value: several for an Either, else the type itself."""
    return tuple(type_.members) if isinstance(type_, Either) else (type_,)


def without_none(type_: Type) -> Type:
    """The type of a value that is known to be something."""
    rest = [member for member in members_of(type_) if member != NOTHING]
    return either(rest) if rest else type_


@cache
def _attributes_of(cls: type) -> Mapping[str, Type]:
    try:
        hints = typing.get_type_hints(cls)
    except (NameError, TypeError, AttributeError):
        hints = {}
    found: dict[str, Type] = {f.name: of_annotation(hints.get(f.name, object)) for f in fields(cls)}
    for name in dir(cls):
        value = getattr(cls, name, None)
        if name.startswith("_") or name in found:
            continue
        if isinstance(value, property) and value.fget is not None:
            found[name] = of_annotation(result_of(value.fget))
        elif callable(value):
            found[name] = Function(of_annotation(result_of(value)))
    return found


def result_of(function: object) -> object:
    """The annotation of what a function returns; `object` where it has none that can be read."""
    try:
        return typing.get_type_hints(function).get("return", object)
    except (NameError, TypeError, AttributeError):
        return object


def attributes(type_: Type) -> Iterable[str] | None:
    """The names of the attributes that a value has; None where that is not known."""
    match type_:
        case Record(cls):
            return _attributes_of(cls)
        case Names(_, known):
            return [name for name, _ in known]
        case Plain(cls):
            return [name for name in dir(cls) if not name.startswith("_")]
        case Many() | Group():
            return [name for name in dir(tuple) if not name.startswith("_")]
        case _:
            return None


def attribute(type_: Type, name: str) -> Type | None:
    """The type of an attribute, or of an item of a mapping; None where there is none."""
    match type_:
        case Record(cls):
            return _attributes_of(cls).get(name)
        case Names(_, known):
            return dict(known).get(name)
        case Plain(cls) if issubclass(cls, enum.Enum):
            return ANYTHING if hasattr(cls, name) or name in {"name", "value"} else None
        case Plain(cls) if issubclass(cls, str) and hasattr(str, name):
            return Function(_TEXT_METHODS.get(name, TRUTH if name.startswith("is") else TEXT))
        case Plain(cls):
            return ANYTHING if hasattr(cls, name) else None
        case Many() | Group():
            # A list has more methods than a tuple, and filters make lists.
            return ANYTHING if hasattr(list, name) else None
        case Table(key, value):
            methods = {"items": Many(Group((key, value))), "keys": Many(key), "values": Many(value)}
            return Function(methods.get(name, ANYTHING)) if hasattr(dict, name) else value
        case Function():
            return None
        case _:
            return ANYTHING


def element_of(type_: Type) -> Type | None:
    """The type of the elements in a loop over a value; None if no loop over it is possible."""
    match type_:
        case Many(element):
            return element
        case Group(elements):
            return either(elements)
        case Table(key, _):
            return key
        case Plain(cls):
            return TEXT if issubclass(cls, str) else NUMBER if issubclass(cls, bytes) else None
        case Record() | Function():
            return None
        case Either(members):
            found = [element for member in members if (element := element_of(member)) is not None]
            return either(found) if found else None
        case _:
            return ANYTHING


def named(type_: Type) -> str:
    """A type in words."""
    match type_:
        case Plain(cls):
            words = {str: "text", int: "an integer", bool: "true or false", float: "a number"}
            return words.get(cls, "nothing" if cls is types.NoneType else f"a value of {cls.__name__}")
        case Record(cls):
            return f"{'an' if cls.__name__[0] in 'AEIOU' else 'a'} {cls.__name__}"
        case Many(Record(cls)):
            return f"a tuple of {cls.__name__}"
        case Many() | Group():
            return "a tuple"
        case Table():
            return "a mapping"
        case Names(title, _):
            return f"`{title}`"
        case Function():
            return "a function"
        case Either(members):
            return " or ".join(sorted(map(named, members)))
        case _:
            return "a value"


def spelled(type_: Type) -> str:
    """A type as an annotation spells it; empty for what has no annotation."""
    match type_:
        case Plain(cls) | Record(cls):
            return "None" if cls is types.NoneType else cls.__name__
        case Many(element):
            return f"tuple[{spelled(element)}, ...]"
        case Group(elements):
            return f"tuple[{', '.join(map(spelled, elements))}]"
        case Either(members):
            return " | ".join(sorted(map(spelled, members)))
        case _:
            return ""
