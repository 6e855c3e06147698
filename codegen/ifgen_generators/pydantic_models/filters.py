"""Filters for the templates of this set: the types of fields as pydantic expresses them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ifgen.model import Field, FieldType, Interface, TypeReference

_ATTRIBUTES = """
construct copy dict from_orm json parse_file parse_obj parse_raw schema schema_json update_forward_refs
validate model_computed_fields model_config model_construct model_copy model_dump model_dump_json
model_extra model_fields model_fields_set model_json_schema model_parametrized_name model_post_init
model_rebuild model_validate model_validate_json model_validate_strings to_message from_message
"""
_RESERVED = frozenset(_ATTRIBUTES.split())
"""The attributes that every model has."""

_PYTHON = {"bool": "bool", "int": "int", "float": "float", "byte": "int", "char": "str", "string": "str"}


def model(message: TypeReference) -> str:
    """The name for the model of a message from another module: `geometry_msgs_msg_Point`."""
    return f"{message.package}_{message.folder}_{message.name}"


def attribute(field: Field) -> str:
    """The name of a field in its model, with `_` where every model has such an attribute."""
    return f"{field.attribute}_" if field.attribute in _RESERVED else field.attribute


def taken(interface: Interface) -> frozenset[str]:
    """The names of classes and fields in a module, in which they do not stand for what it imports."""
    fields = (attribute(field) for message in interface.messages for field in message.fields)
    return frozenset(fields) | {message.name for message in interface.messages}


def free(text: str, interface: Interface) -> str:
    """Names of Python, each with `_` where something in the module has the same one."""
    names = taken(interface)
    return re.sub(r"\w+", lambda match: f"{match[0]}_" if match[0] in names else match[0], text)


def imports(interface: Interface, package: str, converts: bool) -> list[str]:
    """The import statements of a module of `package`, in the order that isort wants."""
    types = [(field.type, field) for message in interface.messages for field in message.fields]
    constants = [of.type for message in interface.messages for of in message.constants]
    texts = [*(annotation(*typed) for typed in types), *map(annotation_of_constant, constants)]
    words = {str(word) for text in texts for word in re.findall(r"\w+", text)}
    if converts:
        words.add("classmethod")
    names = [*(["Annotated"] if "Annotated" in words else []), *(["ClassVar"] if constants else [])]
    hidden = taken(interface)

    def named(*words: str) -> str:
        return ", ".join(f"{word} as {word}_" if word in hidden else word for word in words)

    builtin = sorted(hidden & words & {"bool", "bytes", "classmethod", "float", "int", "list", "str"})
    first = [f"from builtins import {named(*builtin)}"] if builtin else []
    first += [f"from typing import {named(*names)}"] if names else []
    others = [f"from pydantic import {named('BaseModel', 'ConfigDict', *(['Field'] if types else []))}"]
    if converts:
        others.append(f"from {interface.module} import {interface.name} as _{interface.name}")
    for used in interface.uses:
        module = f"{package}.{used.package}.{used.folder}.{used.snake_interface}"
        others.append(f"from {module} import {used.name} as {model(used)}")
    return [*first, *([""] if first else []), *sorted(others)]


def annotation(type_: FieldType, field: Field | None = None) -> str:
    """The annotation of a field, with the bounds of its type, or the narrower ones of its meaning."""
    low: float | None
    high: float | None
    low, high = (0, 255) if type_.base == "byte" else (type_.minimum, type_.maximum)
    bounds = field.meanings.range if field and not field.meanings.invalid else None
    if bounds and type_.base in {"int", "float"}:
        low = low if bounds.minimum is None else bounds.minimum
        high = high if bounds.maximum is None else bounds.maximum
    element = model(type_.message) if type_.message else _PYTHON[type_.base]
    if type_.base == "char":
        return _many("Annotated[str, Field(min_length=1, max_length=1)]", type_)
    element = _bounded(element, ge=low, le=high, max_length=type_.maximum_length)
    return _many(element, type_)


def _many(element: str, type_: FieldType) -> str:
    if not type_.many:
        return element
    return _bounded(f"list[{element}]", min_length=type_.size, max_length=type_.size or type_.maximum_size)


def annotation_of_constant(type_: FieldType) -> str:
    """The annotation of a constant, without bounds."""
    return "bytes" if type_.base == "byte" else _PYTHON[type_.base]


def default_value(field: Field) -> str:
    """The argument that makes the value of a field that is left out."""
    type_ = field.type
    if type_.message and not type_.many:
        return f"default_factory={model(type_.message)}"
    value = field.python_default
    if type_.base == "byte":
        value = field.default or (f"[0] * {type_.size or 0}" if type_.many else "0")
    if type_.message and type_.size:
        value = f"[{model(type_.message)}() for _ in range({type_.size})]"
    return f"default_factory=lambda: {value}" if type_.many else f"default={value}"


def description(field: Field) -> str:
    """The first line about a field in the interface, and its meaning, as a Python literal."""
    text, summary = field.documentation.partition("\n")[0], field.meanings.summary
    texts = (text, f"[{field.unit}]" if field.unit else "", f"({summary})" if summary else "")
    return repr(" ".join(filter(None, texts)))


def docstring_text(text: str) -> str:
    """A text, made safe to stand between triple quotes."""
    first, *more = text.replace("\\", "\\\\").replace('"', '\\"').splitlines()
    return "\n".join([first, *(f"    {line}".rstrip() for line in more)])


def to_message(value: str, type_: FieldType) -> str:
    """The expression for a message's field, from `value`, the model's."""
    element = "{}.to_message()" if type_.message else "bytes([{}])" if type_.base == "byte" else "{}"
    return _each(value, type_, element)


def from_message(value: str, type_: FieldType) -> str:
    """The expression for a model's field, from `value`, the message's, whose arrays may be numpy's."""
    if type_.message:
        element = f"{model(type_.message)}.from_message({{}})"
    elif type_.base == "byte":
        element = "{}[0]"
    else:
        element = f"{_PYTHON[type_.base]}({{}})" if type_.many else "{}"
    return _each(value, type_, element)


def _each(value: str, type_: FieldType, element: str) -> str:
    if not type_.many:
        return element.format(value)
    return value if element == "{}" else f"[{element.format('e')} for e in {value}]"


def _bounded(annotation: str, **bounds: float | None) -> str:
    given = ", ".join(f"{name}={value}" for name, value in _given(bounds).items())
    return f"Annotated[{annotation}, Field({given})]" if given else annotation


def _given(bounds: dict[str, float | None]) -> dict[str, float]:
    return {name: value for name, value in bounds.items() if value is not None}
