"""Type descriptions in whatever form they come, and the classes of the types that they are about."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, cast

from ifgen.definition.described.reading import read
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.dynamic.making import make
from ifgen.dynamic.texts import class_from_sources

_LONGEST: Final = 2**24


class DescribeError(RuntimeError):
    """Nobody describes the type of a topic, for the reason in one sentence."""


@dataclass(frozen=True, slots=True)
class TypeDescription:
    """The description of a type, as a node sent it.

    `document` has the keys `type_description` and `referenced_type_descriptions`. `sources` are the
    definitions that the node knows: (type name, `msg`, `srv`, `action` or `idl`, text). `node` is the name of
    the node that answered.
    """

    type_name: str
    type_hash: str
    document: dict[str, Any] = field(repr=False)
    node: str
    sources: tuple[tuple[str, str, str], ...] = field(default=(), repr=False)


def class_of(description: object, type_hash: str | None = None) -> type[Any]:
    """The class of the type that a description is about.

    `description` is what `describe` returned, a dictionary with the keys `type_description` and
    `referenced_type_descriptions`, its JSON text, a `.json` file of rosidl as a dictionary or text, or a
    `type_description_interfaces/msg/TypeDescription`. If `type_hash` (`RIHS01_...`) is given, the description
    has to fit it.

    Constants and comments are not part of a description: the class has them only if `describe` got the
    definition, too. The same description always returns the same class. Raises InputError for a description
    that is wrong.
    """
    if not isinstance(description, TypeDescription):
        return make(*read(_document_from(description), type_hash))
    type_hash = type_hash or description.type_hash
    described, registry = read(description.document, type_hash)
    if any(text for _, _, text in description.sources):
        try:
            cls = class_from_sources(description.type_name, description.sources)
        except InputError:  # a node may have installed what it was not built with
            pass
        else:
            if cls is not None and cls.__type_hash__ == type_hash:
                return cls
    return make(described, registry)


def _document_from(description: object) -> Mapping[str, Any]:
    """The dictionary of a description that is one, or JSON text, a file of rosidl's, or a message of ROS."""
    if isinstance(description, str | bytes):
        description = _parsed(description)
    if not isinstance(description, Mapping):
        return _document_of(description)
    document = cast("Mapping[str, Any]", description)
    inner = document.get("type_description_msg")  # in a file of rosidl
    return cast("Mapping[str, Any]", inner) if isinstance(inner, Mapping) else document


def _document_of(message: Any) -> dict[str, Any]:
    """The dictionary of a `type_description_interfaces/msg/TypeDescription`. Raises InputError."""
    try:
        return {
            "type_description": _individual(message.type_description),
            "referenced_type_descriptions": [_individual(m) for m in message.referenced_type_descriptions],
        }
    except AttributeError:
        kind = type(message).__name__
        text = f"a type description is a dictionary, JSON text or a TypeDescription message, not a {kind}"
        raise InputError([Diagnostic("invalid-description", text)]) from None


def _individual(message: Any) -> dict[str, Any]:
    return {"type_name": message.type_name, "fields": [_field(field) for field in message.fields]}


def _field(message: Any) -> dict[str, Any]:
    of = message.type
    type_ = {
        "type_id": of.type_id,
        "capacity": of.capacity,
        "string_capacity": of.string_capacity,
        "nested_type_name": of.nested_type_name,
    }
    return {"name": message.name, "type": type_, "default_value": message.default_value}


def _parsed(text: str | bytes) -> object:
    try:
        if len(text) > _LONGEST:
            raise ValueError(f"it is longer than {_LONGEST} characters")
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        message = f"this is not the JSON of a type description: {error}"
        raise InputError([Diagnostic("invalid-description", message)]) from None
