"""Definitions in files: their texts, compared with classes, and the classes that they stand for."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final, TypeAlias

from ifgen_runtime.bag.errors import BagError, warn
from ifgen_runtime.bag.topics import Channel, Definition
from ifgen_runtime.codec import decode_any, deserialize
from ifgen_runtime.codec.choice import attached
from ifgen_runtime.field_types import Basic, Field, Text, fields_of, message_class, type_name
from ifgen_runtime.importing import ensure_importable, messages
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


_GROUP: Final = "ifgen.bag"
"""The entry point of what makes classes: `class_from_text(type_name, text, idl=...)`, of the toolkit."""

Decode: TypeAlias = Callable[[bytes], Any]


class Classes:
    """Finds the class of each definition, once."""

    def __init__(self, given: Mapping[str, type[Any]], place: str) -> None:
        self._given = given
        self._place = place
        self._found: dict[Definition, type[Any]] = {}

    def of(self, channel: Channel) -> type[Any]:
        """The class of a channel's messages. Raises BagError if there is none."""
        if channel.encoding != "cdr":
            text = (
                f"messages of {channel.topic} are encoded as {channel.encoding[:40]!r}, and ifgen reads cdr"
            )
            raise BagError(f"{self._place}: {text}")
        definition = channel.definition
        found = self._found.get(definition)
        if found is None:
            found = self._found[definition] = self._find(channel.topic, definition)
        return found

    def _find(self, topic: str, definition: Definition) -> type[Any]:
        name = definition.type_name
        if name in self._given:
            return self._given[name]
        installed = _installed(name)
        if installed is not None and _is_same(definition, installed):
            return installed
        if definition.text and definition.encoding in ("ros2msg", "ros2idl"):
            return self._made(topic, definition, installed)
        if installed is not None and not definition.type_hash and not definition.text:
            return installed  # nothing tells more, as in bags before ROS 2 Iron
        raise BagError(f"{self._place}: {_no_class(topic, definition, installed)}")

    def _made(self, topic: str, definition: Definition, installed: type[Any] | None) -> type[Any]:
        make = _maker()
        if make is None:
            from ifgen_runtime.installation import (
                add_toolkit,
            )  # takes long to load, and only an error needs it

            problem = _no_class(topic, definition, installed)
            raise BagError(f"{self._place}: {problem}. The toolkit makes one from the file: {add_toolkit()}")
        try:
            cls: type[Any] = make(definition.type_name, definition.text, idl=definition.encoding == "ros2idl")
        except Exception as error:  # the toolkit's InputError, which this package must not import
            text = f"the definition of {definition.type_name} in it cannot be used: {error}"
            raise BagError(f"{self._place}: {text}") from error
        if definition.type_hash and type_hash(cls) != definition.type_hash:
            warn(
                f"{self._place}: the definition of {definition.type_name} in it has not the type hash that "
                f"{topic} was published with: its messages may be read wrongly"
            )
        if installed is not None and type_hash(cls) == type_hash(installed):
            return installed
        return cls


def decoder(cls: type[Any], views: bool) -> Decode:
    """The fastest function that makes a message of bytes, or one with views of them."""
    if views:
        from ifgen_runtime.views import decoders  # with numpy, which a program may not need

        return decoders[cls]
    if "__codec__" in vars(cls):
        return attached(cls)[1]
    if hasattr(cls, "__deserialize__"):
        return lambda data: deserialize(data, cls)
    return lambda data: decode_any(data, cls)


def _installed(name: str) -> type[Any] | None:
    """The class that a program would import; ours, where there is no other."""
    package, *middle, own = name.split("/") if name.count("/") == 2 else ("", "", "")
    if not (package.isidentifier() and own.isidentifier() and middle[0] in ("msg", "srv", "action")):
        return None
    if package not in sys.modules and (messages() / package).is_dir():
        ensure_importable(package)
    try:
        found = message_class(f"{package}.{middle[0]}", own)
    except (ImportError, AttributeError):
        return None
    return found if hasattr(found, "get_fields_and_field_types") else None


def _is_same(definition: Definition, cls: type[Any]) -> bool:
    if definition.type_hash:
        return definition.type_hash == getattr(cls, "__type_hash__", "") or definition.type_hash == type_hash(
            cls
        )
    if definition.encoding == "ros2msg" and definition.text:
        return is_definition_of(definition.type_name, definition.text, cls) is True
    return False


def _maker() -> Callable[..., type[Any]] | None:
    from importlib.metadata import entry_points  # takes long to load, and most types are installed

    for found in entry_points(group=_GROUP, name="class_from_text"):
        try:
            make: Callable[..., type[Any]] = found.load()
        except ImportError:
            return None
        return make
    return None


def _no_class(topic: str, definition: Definition, installed: type[Any] | None) -> str:
    name = definition.type_name or "its type"
    if installed is None:
        return f"there is no class for {name} of {topic}: no installed package has it"
    return f"the installed class of {name} has another definition than {topic} in the file"
