"""The texts of definitions in files: written for a class, and compared with a class."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final

from ifgen_runtime.bag.topics import Definition
from ifgen_runtime.field_types import Basic, Field, Text, fields_of, type_name
from ifgen_runtime.type_description import sources, type_hash

_SEPARATOR: Final = re.compile(r"^={80}\n(?:MSG|IDL): (\S+)[ \t]*\n", re.MULTILINE)
_FIELD: Final = re.compile(r"(?P<type>[\w/\[\]<=]+)\s+(?P<name>\w+)\s*(?P<rest>.*)")
_TYPE: Final = re.compile(r"(?P<base>[\w/]+)(?:<=(?P<bound>\d+))?(?P<array>\[(?:<=)?\d*\])?")

_WORDS: Final = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}
"""The words of .msg files for basic types whose name differs."""

_SAME: Final = {"char": "uint8"}
"""Words of .msg files that mean the type of another word."""

Fields = list[tuple[str, str]]
"""Types, in the words of .msg files with full names, and names."""


def short_name(full: str) -> str:
    """`pkg/Name` for `pkg/msg/Name`, as definitions that follow each other name messages."""
    package, folder, name = full.split("/", 2)
    return f"{package}/{name}" if folder == "msg" else full


def full_name(short: str, package: str = "") -> str:
    """`pkg/msg/Name` for `pkg/Name`, or for `Name` in a package."""
    parts = short.split("/")
    if len(parts) == 1:
        return "std_msgs/msg/Header" if short == "Header" else f"{package}/msg/{short}"
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else short


def type_in(name: str) -> str:
    """The name of a type as a file has it; some writers leave `msg` out."""
    return full_name(name) if name.count("/") == 1 else name


def definition_of(cls: type[Any]) -> Definition:
    """The definition of a message class, as bags have it."""
    generated = next((of for of in cls.__mro__ if "__type_hash__" in vars(of)), cls)  # of one with checks
    return Definition(type_name(generated), type_hash(generated), "ros2msg", full_text(generated))


def full_text(cls: type[Any]) -> str:
    """The definition of a message class and of all that it refers to, in one text, as in bags."""
    texts: list[str] = []
    for (name, encoding, text), (_, of) in zip(sources(cls), _classes(cls), strict=True):
        own = text if encoding == "msg" and text else _written(of)
        head = f"{'=' * 80}\nMSG: {short_name(name)}\n" if texts else ""
        texts.append(head + (own if own.endswith("\n") or not own else f"{own}\n"))
    return "".join(texts)


def is_definition_of(type_name: str, text: str, cls: type[Any]) -> bool | None:
    """Whether a text of .msg files defines what a class is. None if that cannot be told from it."""
    theirs = _parsed(type_name, text)
    for name, of in _classes(cls):
        if name not in theirs and name.startswith("builtin_interfaces/"):
            continue  # old tools left these out
        found = theirs.get(name)
        if found is None:
            return None
        if found != _fields(of):
            return False
    return True


def _classes(cls: type[Any]) -> list[tuple[str, type[Any]]]:
    """A class, then all that it refers to, in the order of `type_description.sources`."""
    known: dict[str, type[Any]] = {}
    pending = [cls]
    while pending:
        for field in fields_of(pending.pop()):
            if isinstance(field.type, type) and type_name(field.type) not in known:
                known[type_name(field.type)] = field.type
                pending.append(field.type)
    return [(type_name(cls), cls), *sorted(known.items())]


def _fields(cls: type[Any]) -> Fields:
    return [(_word(field), field.name) for field in fields_of(cls)]


def _word(field: Field) -> str:
    """The type of a field in the words of .msg files."""
    if isinstance(field.type, Basic):
        base = _WORDS.get(field.type.name, field.type.name)
        base = _SAME.get(base, base)
    elif isinstance(field.type, Text):
        base = ("wstring" if field.type.wide else "string") + (
            "" if field.type.maximum is None else f"<={field.type.maximum}"
        )
    else:
        base = type_name(field.type)
    if field.size is not None:
        return f"{base}[{field.size}]"
    if field.is_sequence:
        return f"{base}[]" if field.maximum is None else f"{base}[<={field.maximum}]"
    return base


def _written(cls: type[Any]) -> str:
    """A text for a class that does not know its own: without constants, defaults and comments."""
    return "".join(f"{_shortened(word)} {name}\n" for word, name in _fields(cls))


def _shortened(word: str) -> str:
    return re.sub(r"^(\w+)/msg/(\w+)", r"\1/\2", word)


def _parsed(name: str, text: str) -> dict[str, Fields]:
    """The fields of each type in a text, by its full name."""
    main, *more = _SEPARATOR.split(text.replace("\r\n", "\n"))
    texts = {full_name(short): body for short, body in zip(more[::2], more[1::2], strict=True)}
    if main.strip() or name not in texts:
        texts[name] = main
    return {of: list(_lines(of, body)) for of, body in texts.items()}


def _lines(of: str, text: str) -> Iterator[tuple[str, str]]:
    for line in text.splitlines():
        stripped = line.partition("#")[0].strip()
        if not stripped:
            continue
        match = _FIELD.fullmatch(stripped)
        type_ = _TYPE.fullmatch(match["type"]) if match else None
        if match is None or type_ is None:
            yield ("", stripped)  # equal to nothing
        elif not match["rest"].startswith("="):
            yield (_full_type(type_, of.partition("/")[0]), match["name"])


def _full_type(type_: re.Match[str], package: str) -> str:
    base = type_["base"]
    if "/" in base or base[0].isupper():
        base = full_name(base, package)
    bound = f"<={int(type_['bound'])}" if type_["bound"] else ""
    return f"{_SAME.get(base, base)}{bound}{type_['array'] or ''}"
