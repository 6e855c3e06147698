"""The classes of recorded messages: installed ones of the same definition, or made from the file's text."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from typing import Any, Final, TypeAlias

from ifgen_runtime.bag.definitions import is_definition_of
from ifgen_runtime.bag.errors import BagError, warn
from ifgen_runtime.bag.topics import Channel, Definition
from ifgen_runtime.codec import decode_any, deserialize
from ifgen_runtime.codec.choice import attached
from ifgen_runtime.field_types import message_class
from ifgen_runtime.importing import ensure_importable, messages
from ifgen_runtime.type_description import type_hash

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
