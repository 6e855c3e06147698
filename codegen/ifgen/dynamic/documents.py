"""Type descriptions as dictionaries, from whatever form they come in."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final, cast

from ifgen.diagnostics import Diagnostic, InputError

_LONGEST: Final = 2**24


def document_from(description: object) -> Mapping[str, Any]:
    """The dictionary of a description that is one, or JSON text, a file of rosidl's, or a message of ROS."""
    if isinstance(description, str | bytes):
        description = _parsed(description)
    if not isinstance(description, Mapping):
        return document_of(description)
    document = cast("Mapping[str, Any]", description)
    inner = document.get("type_description_msg")  # in a file of rosidl
    return cast("Mapping[str, Any]", inner) if isinstance(inner, Mapping) else document


def document_of(message: Any) -> dict[str, Any]:
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
