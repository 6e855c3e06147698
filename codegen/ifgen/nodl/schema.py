"""NoDL as ifgen reads it, as a JSON schema: for editors, which complete keys, explain them and mark mistakes.

It is put together from what the reader reads by. What depends on anything but the shape of one document, such
as whether a type exists, is for `ifgen check` to say.
"""

from __future__ import annotations

import json
from typing import Any, Final, TypeAlias, cast, get_args

from ifgen import resources
from ifgen.nodl import document, endpoints, names, parameters, values
from ifgen.nodl.model import Category, ParameterType
from ifgen.nodl.options import Options
from ifgen.nodl.validators import CUSTOM, RULES, Arguments, fits

Schema: TypeAlias = dict[str, Any]
_Json: TypeAlias = "dict[str, _Json] | list[_Json] | str | float | bool | None"

_TEXT: Final[Schema] = {"type": "string"}
_SAID: Final = {
    "nodl_version": "The version of NoDL: 2.",
    "description": "For people: a description, or the purpose.",
    "codegen": "For code generators: a map for each.",
    "include": "Documents that are parts of this one.",
    "ref": "local://FILE, relative to this file, or nodl://PACKAGE/NAME.",
    "parameters": "The parameters of the node; a dot in a name makes a group.",
    "publishers": "The topics that the node publishes.",
    "subscriptions": "The topics that the node subscribes to.",
    "service_servers": "The services that the node offers.",
    "service_clients": "The services that the node calls.",
    "action_servers": "The actions that the node executes.",
    "action_clients": "The actions that the node sends goals to.",
    "name": "Absolute (/a/b), relative (a/b) or private (~/a).",
    "history": "Which messages are kept until they are delivered.",
    "depth": "How many messages KEEP_LAST keeps.",
    "reliability": "Whether lost messages are sent again.",
    "durability": "Whether late subscriptions get earlier messages.",
    "deadline_ns": "The longest time between two messages [ns]; 0 leaves it open.",
    "lifespan_ns": "How old a message may be when it is delivered [ns]; 0 leaves it open.",
    "liveliness": "How a publisher shows that it is alive.",
    "liveliness_lease_duration_ns": "How soon it must show that again [ns]; 0 leaves it open.",
    "type": "The type of the values.",
    "default_value": "Without one, the parameter needs a value when the node starts.",
    "read_only": "Whether it can be set only when the node starts.",
    "additional_constraints": "Further constraints, in words.",
    "validation": "Validators that every value must pass, each with its argument.",
    "bounds": "[lower, upper], both allowed.",
    "lt": "Less than this.",
    "gt": "Greater than this.",
    "lt_eq": "This or less.",
    "gt_eq": "This or greater.",
    "element_bounds": "[lower, upper] for each element, both allowed.",
    "lower_element_bounds": "Each element is this or greater.",
    "upper_element_bounds": "Each element is this or less.",
    "one_of": "[[a, b, ...]]: one of these.",
    "subset_of": "[[a, b, ...]]: each element is one of these.",
    "unique": "No element twice; without an argument.",
    "not_empty": "At least one element or character; without an argument.",
    "fixed_size": "Exactly this many elements or characters.",
    "size_gt": "More elements or characters than this.",
    "size_lt": "Fewer elements or characters than this.",
}


def schema() -> Schema:
    """The JSON schema (draft 7) of a document."""
    options = cast("Schema", _untitled(Options.model_json_schema()))
    definitions = options.pop("$defs")
    fields: Schema = {
        "nodl_version": {"const": document.VERSION},
        "description": _TEXT,
        "codegen": {
            "type": "object",
            "properties": {"ifgen": {"$ref": "#/definitions/Options"}},
            "additionalProperties": {"type": "object"},
        },
        "include": _list(_table({"ref": _TEXT}, ["ref"])),
        "parameters": {
            "type": "object",
            "propertyNames": {"pattern": names.PARAMETER, "maxLength": names.MAX_NAME},
            "additionalProperties": {"$ref": "#/definitions/Parameter"},
        },
        **{category.value: _list(_endpoint(category)) for category in Category},
    }
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "$id": resources.NODL_SCHEMA,
        "title": "The public interface of a ROS 2 node, in NoDL, as ifgen reads it",
        **_table(fields, ["nodl_version"]),
        "definitions": {
            **cast("Schema", _with_definitions({"Options": options, **definitions})),
            "Qos": _qos(),
            "Parameter": _parameter(),
        },
    }


def _table(fields: Schema, required: list[str]) -> Schema:
    """A map with these keys and no others."""
    explained = {
        key: {"description": _SAID[key], **field} if key in _SAID else field for key, field in fields.items()
    }
    return {
        "type": "object",
        "properties": explained,
        "required": required,
        "additionalProperties": False,
    }


def _list(items: Schema) -> Schema:
    return {"type": "array", "items": items}


def _endpoint(category: Category) -> Schema:
    folder = category.folder
    known, required = endpoints.keys(category)
    fields: Schema = {
        "name": {
            **_TEXT,
            "pattern": names.ENDPOINT,
            "patternErrorMessage": "A name is /a/b, a/b or ~/a: letters and digits, no digit first.",
            "maxLength": names.MAX_ENDPOINT_NAME,
        },
        "type": {
            **_TEXT,
            "description": f"package/{folder}/Name, or package/Name.",
            "pattern": f"^{names.TYPE.replace('msg|srv|action', folder)}$",
            "patternErrorMessage": f"A type here is package/{folder}/Name or package/Name.",
        },
        "qos": {"$ref": "#/definitions/Qos"},
        "description": _TEXT,
    }
    return _table({key: fields[key] for key in known}, list(required))


def _qos() -> Schema:
    policies: Schema = {
        str(name): {"enum": list(get_args(words))} for name, words in endpoints.POLICIES.items()
    }
    duration = {"type": "integer", "minimum": 0, "maximum": endpoints.MAX_NS}
    fields: Schema = {
        **policies,
        "depth": {"type": "integer", "minimum": 1, "maximum": endpoints.MAX_DEPTH},
        **dict.fromkeys(endpoints.DURATIONS, duration),
    }
    keeps_last = {"properties": {"history": {"const": "KEEP_LAST"}}, "required": ["history"]}
    return {
        **_table({key: fields[key] for key in endpoints.QOS_KEYS}, ["history", "reliability"]),
        "if": keeps_last,
        "then": {"required": ["depth"]},
    }


def _parameter() -> Schema:
    known = [*values.SCALARS, *values.ARRAYS]
    fields: Schema = {
        "type": {**_TEXT, "anyOf": [{"enum": known}, {"pattern": f"^{values.FIXED_SIZE}$"}]},
        "default_value": {},
        "description": _TEXT,
        "read_only": {"type": "boolean"},
        "additional_constraints": _TEXT,
        "validation": {"type": "object"},
    }
    types = {f"^{name}(_fixed_[0-9]+)?$": values.parameter_type(name) for name in known}
    return {
        **_table({key: fields[key] for key in parameters.KEYS}, ["type"]),
        "allOf": [
            {
                "if": {"properties": {"type": {**_TEXT, "pattern": pattern}}, "required": ["type"]},
                "then": {"properties": _of_type(type_)},
            }
            for pattern, type_ in types.items()
            if type_ is not None
        ],
    }


def _of_type(type_: ParameterType) -> Schema:
    """The schema of the default and the validators of a parameter of a type."""
    if type_.base == "none":
        default: Schema | bool = False
    else:
        default = _list(_scalar(type_.base)) if type_.array else _scalar(type_.base)
    built_in = {
        name: _arguments(rule.arguments, type_.base) for name, rule in RULES.items() if fits(rule, type_)
    }
    alike: dict[str, list[str]] = {}
    for name, arguments in built_in.items():
        alike.setdefault(json.dumps(arguments), []).append(name)
    patterns = {f"^({'|'.join(names)})<>$": built_in[names[0]] for names in alike.values()}
    validation = {
        "properties": {name: {"description": _SAID[name], **a} for name, a in built_in.items()},
        "patternProperties": {**patterns, f"^{CUSTOM}$": _free_arguments()},
        "additionalProperties": False,
    }
    return {"default_value": default, "validation": validation}


def _scalar(base: str) -> Schema:
    low, high = values.INT64
    of: dict[str, Schema] = {
        "bool": {"type": "boolean"},
        "int": {"type": "integer", "minimum": low, "maximum": high},
        "double": {"type": "number"},
        "string": _TEXT,
        "byte": {"type": "integer", "minimum": 0, "maximum": 255},
    }
    return of[base]


def _arguments(arguments: Arguments, base: str) -> Schema:
    nothing = {"anyOf": [{"type": "null"}, {"type": "array", "maxItems": 0}]}
    if arguments == "none":
        return nothing
    scalar = {"type": "integer", "minimum": 0} if arguments == "size" else _scalar(base)
    match arguments:
        case "pair":
            return {**_list(scalar), "minItems": 2, "maxItems": 2}
        case "choices":
            return {**_list({**_list(scalar), "minItems": 1}), "minItems": 1, "maxItems": 1}
        case "one" | "size":
            return {"anyOf": [scalar, {**_list(scalar), "minItems": 1, "maxItems": 1}]}


def _free_arguments() -> Schema:
    scalar = ["number", "string", "boolean"]
    return {"type": [*scalar, "null", "array"], "items": {"type": scalar}}


def _untitled(found: _Json) -> _Json:
    """Without the titles that pydantic makes of names."""
    if isinstance(found, list):
        return [_untitled(item) for item in found]
    if not isinstance(found, dict):
        return found
    kept = {key: value for key, value in found.items() if key != "title" or not isinstance(value, str)}
    return {key: _untitled(value) for key, value in kept.items()}


def _with_definitions(found: _Json) -> _Json:
    """With references to `definitions`, where draft 7 has what pydantic calls `$defs`."""
    if isinstance(found, list):
        return [_with_definitions(item) for item in found]
    if isinstance(found, dict):
        return {key: _with_definitions(value) for key, value in found.items()}
    return found.replace("#/$defs/", "#/definitions/") if isinstance(found, str) else found
