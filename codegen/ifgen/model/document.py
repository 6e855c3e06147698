"""The model as JSON: one document, its schema, and back to objects."""

from __future__ import annotations

import dataclasses
import json
import math
import types
import typing
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, Final, cast

from ifgen.model.interfaces import Interface, Meaning, Message, Model
from ifgen.model.wire import Step

VERSION: Final = "1.1"
"""The version of the model. A minor one only adds members, which readers of an older one must ignore."""

SCHEMA: Final = "https://raw.githubusercontent.com/ifgen-ros/ifgen/main/docs/model-1.schema.json"
"""The address of the JSON schema, in `$schema` of each document."""

MAX_NUMBER: Final = 2**53 - 1
"""The largest integer that is a number in the document; a larger one is its decimal text."""

_REFERENCES: Final = {(Interface, "messages"), (Interface, "types")}
"""Members that name messages, which stand in `types` of the document."""

_DEFAULTS: Final[Mapping[type, Mapping[str, object]]] = {
    cls: {
        field.name: [] if field.default == () else field.default
        for field in dataclasses.fields(cls)
        if field.default is not dataclasses.MISSING
    }
    for cls in (Step, Meaning)
}
"""The members that are left out of the document where they have these values."""


def document(model: Model) -> dict[str, Any]:
    """The model as the JSON document that generators get, in what `json` writes."""
    return {"$schema": SCHEMA, **cast("dict[str, Any]", plain(model))}


def to_text(model: Model) -> str:
    """The document as text, indented and always the same for the same model."""
    return json.dumps(document(model), indent=1, ensure_ascii=False) + "\n"


def plain(value: Any) -> Any:
    """Any value of the model in what JSON knows: the filter `tojson` of templates writes that."""
    match value:
        case bool() | str() | None:
            return value
        case int():
            return value if -MAX_NUMBER <= value <= MAX_NUMBER else str(value)
        case float():
            return value if math.isfinite(value) else str(value)
        case tuple() | list():
            return [plain(element) for element in cast("Iterable[object]", value)]
        case Mapping():
            return {str(key): plain(of) for key, of in cast("Mapping[object, object]", value).items()}
        case _:
            return _object_as_json(value)


def _object_as_json(value: object) -> dict[str, Any]:
    cls: type = type(value)
    if not dataclasses.is_dataclass(cls):
        raise TypeError(f"{value!r} is not JSON")
    members = {name: _member(cls, name, getattr(value, name)) for name in _hints(cls)}
    defaults = _DEFAULTS.get(cls)
    return (
        {name: of for name, of in members.items() if of != defaults.get(name, ...)} if defaults else members
    )


def _member(cls: type, name: str, value: Any) -> Any:
    if (cls, name) in _REFERENCES:
        return [message.type_name for message in value]
    return plain(value)


def read(document: Mapping[str, Any]) -> Model:
    """The model from its document. Members that it does not know are ignored.

    Raises ValueError if the document is of another major version, and KeyError or TypeError if it is none.
    """
    version = str(document["model"])
    if version.partition(".")[0] != VERSION.partition(".")[0]:
        raise ValueError(f"this is version {version} of the model, and ifgen has {VERSION}")
    known = {of["type_name"]: _object(Message, of, {}) for of in document["types"]}
    return cast("Model", _object(Model, document, known))


def _object(cls: Any, value: Mapping[str, Any], known: Mapping[str, Message]) -> Any:
    members: dict[str, Any] = {}
    for name, hint in _hints(cls).items():
        if name not in value and name not in _required(cls):
            continue
        if (cls, name) in _REFERENCES:
            members[name] = tuple(known[of] for of in value[name])
        elif cls is Model and name == "types":
            members[name] = tuple(known.values())
        else:
            members[name] = _value(hint, value[name], known)
    return cls(**members)


def _value(hint: Any, value: Any, known: Mapping[str, Message]) -> Any:
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if value is None:
        return None
    if origin in {typing.Union, types.UnionType}:
        rest = [argument for argument in arguments if argument is not types.NoneType]
        if len(rest) == 1:
            return _value(rest[0], value, known)
        # Only of numbers and texts, of which large and special ones are text.
        return value
    if origin is tuple:
        return tuple(_value(arguments[0], element, known) for element in value)
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return _object(hint, value, known)
    if hint is int and isinstance(value, str):
        return int(value)
    return value


@cache
def _hints(cls: type) -> dict[str, Any]:
    hints = typing.get_type_hints(cls)
    return {field.name: hints[field.name] for field in dataclasses.fields(cls)}


@cache
def _required(cls: type) -> tuple[str, ...]:
    return tuple(
        field.name
        for field in dataclasses.fields(cls)
        if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    )


def schema() -> dict[str, Any]:
    """The JSON schema of the document. Unknown members are allowed: later versions have more."""
    definitions: dict[str, Any] = {}
    top = _schema_of(Model, definitions)
    model = definitions.pop("Model")
    properties = {"$schema": {"type": "string"}, **model["properties"]}
    assert top == {"$ref": "#/$defs/Model"}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": SCHEMA,
        "title": f"The model of ifgen, version {VERSION}",
        "description": model["description"],
        "type": "object",
        "required": ["$schema", *model["required"]],
        "properties": properties,
        "$defs": dict(sorted(definitions.items())),
    }


_BASIC: Final[Mapping[Any, Mapping[str, Any]]] = {
    str: {"type": "string"},
    bool: {"type": "boolean"},
    int: {"type": ["integer", "string"], "pattern": "^-?[0-9]+$"},
    float: {"type": "number"},
    types.NoneType: {"type": "null"},
    typing.Any: {},
}


def _schema_of(hint: Any, definitions: dict[str, Any]) -> dict[str, Any]:
    if hint in _BASIC:
        return dict(_BASIC[hint])
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in {typing.Union, types.UnionType}:
        if {bool, int, float, str}.issubset(arguments):
            rest = ["null"] if types.NoneType in arguments else []
            return {"type": ["boolean", "number", "string", *rest]}
        return {"anyOf": [_schema_of(argument, definitions) for argument in arguments]}
    if origin is typing.Literal:
        return {"enum": list(arguments)}
    if origin is tuple:
        return {"type": "array", "items": _schema_of(arguments[0], definitions)}
    if origin is not None and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _schema_of(arguments[1], definitions)}
    name = hint.__name__
    if name not in definitions:
        definitions[name] = {}  # a step has steps
        definitions[name] |= {
            "description": " ".join(str(hint.__doc__).split()),
            "type": "object",
            "required": list(_required(hint) if hint in _DEFAULTS else _hints(hint)),
            "properties": {
                member: {"type": "array", "items": {"type": "string"}}
                if (hint, member) in _REFERENCES
                else _schema_of(of, definitions)
                for member, of in _hints(hint).items()
            },
        }
    return {"$ref": f"#/$defs/{name}"}
