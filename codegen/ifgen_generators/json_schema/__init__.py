"""JSON Schema 2020-12 of interfaces, for their values as rosbridge and web pages write them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from ifgen.generators import File, Generator, Option, Request, Response
from ifgen.model import Constant, Field, FieldType, Interface, Message, Value

_DRAFT: Final = "https://json-schema.org/draft/2020-12/schema"
_BASE64: Final = "^(?:[A-Za-z0-9+/]{4})*(?:[A-Za-z0-9+/]{2}==|[A-Za-z0-9+/]{3}=)?$"
_SPECIAL: Final = ["NaN", "Infinity", "-Infinity"]


def generate(request: Request) -> Response:
    """A schema for each interface, with all messages that it needs in its `$defs`."""
    types = {message.type_name: message for message in request.model.types}
    return Response(
        tuple(
            File(_path(interface), json.dumps(_schema(interface, types, request.options), indent=2) + "\n")
            for package in request.model.packages
            for interface in package.interfaces
            if interface.generate
        )
    )


def _path(interface: Interface) -> str:
    return f"{interface.package}/{interface.folder}/{interface.name}.json"


def _schema(interface: Interface, types: Mapping[str, Message], options: Mapping[str, Any]) -> dict[str, Any]:
    parts = interface.messages
    needed = {part.type_name: part for part in parts}
    pending = list(parts)
    while pending:
        for name in pending.pop().dependencies:
            if name not in needed:
                needed[name] = types[name]
                pending.append(types[name])
    schema: dict[str, Any] = {"$schema": _DRAFT}
    if options["id"]:
        schema["$id"] = f"{options['id'].rstrip('/')}/{_path(interface)}"
    schema |= {"title": interface.type_name, "x-ros-type-hash": interface.type_hash}
    if interface.documentation:
        schema["description"] = interface.documentation
    if interface.kind == "message":
        schema["$ref"] = _reference(interface.type_name)
    else:  # both parts of a call, as one value
        schema |= {
            "type": "object",
            "properties": {part.kind: {"$ref": _reference(part.type_name)} for part in parts},
            "additionalProperties": False,
        }
    schema["$defs"] = {_key(name): _message(of, options) for name, of in sorted(needed.items())}
    return schema


def _key(type_name: str) -> str:
    return type_name.replace("/", ".")


def _reference(type_name: str) -> str:
    return f"#/$defs/{_key(type_name)}"


def _message(message: Message, options: Mapping[str, Any]) -> dict[str, Any]:
    constants = {constant.name: constant.exact_value.value for constant in message.constants}
    return {
        "title": message.type_name,
        **({"description": message.documentation} if message.documentation else {}),
        "type": "object",
        "properties": {field.name: _field(field, message, options) for field in message.fields},
        "required": [field.name for field in message.fields] if options["required"] else [],
        "additionalProperties": False,
        **({"x-ros-constants": constants} if constants else {}),
    }


def _field(field: Field, message: Message, options: Mapping[str, Any]) -> dict[str, Any]:
    found = _type(field.type, options)
    owned = [constant for constant in message.constants if constant.name in field.constants]
    if owned:
        found["x-ros-constants"] = {constant.name: _literal(constant, options) for constant in owned}
    _restrict(found, field, owned, options)
    unit, summary = field.unit, field.meanings.summary
    texts = (field.documentation, f"[{unit}]" if unit else "", f"({summary})" if summary else "")
    text = " ".join(filter(None, texts))
    if text:
        found["description"] = text
    if field.default_value is not None:
        found["default"] = _value(field.default_value, field.type, options)
    if field.default_elements is not None and "contentEncoding" not in found:
        found["default"] = [_value(each, field.type, options) for each in field.default_elements]
    return found


def _restrict(
    schema: dict[str, Any], field: Field, owned: Sequence[Constant], options: Mapping[str, Any]
) -> None:
    """Add the meaning of a field: bounds and values of its elements, deprecation, unit and frame."""
    meaning = field.meanings
    elements = schema["items"] if schema.get("type") == "array" else schema
    if elements.get("type") == "integer" or elements.get("type") == "number":
        bounds = meaning.range
        low, high = (bounds.minimum, bounds.maximum) if bounds else (None, None)
        limits = {"minimum": low, "maximum": high}
        elements |= {name: limit for name, limit in limits.items() if limit is not None}
        if meaning.closed and owned:
            elements["enum"] = list(dict.fromkeys(_literal(constant, options) for constant in owned))
        if meaning.invalid and (bounds or "enum" in elements) and not isinstance(meaning.invalid.value, str):
            kept = {name: elements.pop(name) for name in ("minimum", "maximum", "enum") if name in elements}
            elements["anyOf"] = [kept, {"const": meaning.invalid.value}]
    if meaning.deprecated is not None:
        schema["deprecated"] = True
    others = {"x-unit": meaning.normal_unit, "x-frame": meaning.frame}
    schema |= {name: text for name, text in others.items() if text}


def _literal(constant: Constant, options: Mapping[str, Any]) -> Any:
    return _value(constant.exact_value, constant.type, options)


def _value(value: Value, type_: FieldType, options: Mapping[str, Any]) -> Any:
    if type_.primitive in {"int64", "uint64"} and options["int64"] == "string":
        return value.exact
    if isinstance(value.value, float) and value.exact in {"nan", "inf", "-inf"}:
        texts = {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}
        return texts[value.exact] if options["nonfinite"] == "string" else None
    return value.value


def _type(type_: FieldType, options: Mapping[str, Any]) -> dict[str, Any]:
    if type_.array is None:
        return _element(type_, options)
    size = type_.array.size
    if options["bytes"] == "base64" and type_.primitive in {"uint8", "byte", "char"}:
        return {"type": "string", "contentEncoding": "base64", "pattern": _BASE64, **_base64_length(type_)}
    bounds = {"maxItems": size, "minItems": size if type_.array.kind == "fixed" else None}
    return {"type": "array", "items": _element(type_, options), **_given(bounds)}


def _base64_length(type_: FieldType) -> dict[str, Any]:
    if type_.array is None or type_.array.size is None:
        return {}
    length = (type_.array.size + 2) // 3 * 4
    return {"maxLength": length, **({"minLength": length} if type_.array.kind == "fixed" else {})}


def _element(type_: FieldType, options: Mapping[str, Any]) -> dict[str, Any]:
    match type_.primitive:
        case "message":
            assert type_.message is not None, "of a message"
            return {"$ref": _reference(type_.message.type_name)}
        case "bool":
            return {"type": "boolean"}
        case "string" | "wstring":
            return {"type": "string", **_given({"maxLength": type_.string_bound})}
        case "float32" | "float64":
            return dict(_floats(options["nonfinite"]))
        case "byte" | "char":
            return {"type": "integer", "minimum": 0, "maximum": 255}
        case "int64" | "uint64" if options["int64"] == "string":
            sign = "-?" if type_.primitive == "int64" else ""
            return {"type": "string", "pattern": f"^{sign}[0-9]+$"}
        case _:
            return {"type": "integer", "minimum": type_.minimum, "maximum": type_.maximum}


def _floats(nonfinite: str) -> Iterator[tuple[str, Any]]:
    match nonfinite:
        case "null":
            yield "type", ["number", "null"]
        case "string":
            yield "anyOf", [{"type": "number"}, {"enum": _SPECIAL}]
        case _:
            yield "type", "number"


def _given(bounds: Mapping[str, int | None]) -> dict[str, int]:
    return {name: value for name, value in bounds.items() if value is not None}


GENERATOR = Generator(
    name="json-schema",
    version="1.0",
    description="JSON Schema 2020-12, a file for each interface with all that it needs",
    options=(
        Option("bytes", "string", "array", "arrays of bytes: numbers, or base64 text", ("array", "base64")),
        Option(
            "int64", "string", "number", "64-bit integers: numbers, or decimal text", ("number", "string")
        ),
        Option(
            "nonfinite",
            "string",
            "refuse",
            "NaN and infinities: not allowed, null, or text",
            ("refuse", "null", "string"),
        ),
        Option("required", "boolean", False, "whether an object must have all fields"),
        Option("id", "string", "", "the beginning of each $id, such as https://example.com/schemas"),
    ),
    generate=generate,
)
"""The generator, for the entry point."""
