"""SLOT_TYPES: the field types of a message as objects of rosidl_parser.definition."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ifgen_runtime.field_types import Basic, Field, Text, fields_of


def slot_types_of(message_class: type) -> tuple[Any, ...]:
    """One type object a field, of the rosidl_parser that can be imported (ROS's, the underlay's), or ours."""
    definition = _definition()
    return tuple(_slot_type(field, definition) for field in fields_of(message_class))


def _definition() -> Any:
    try:
        return import_module("rosidl_parser.definition")
    except ImportError:
        return import_module("ifgen_runtime.rosidl_types")


def _slot_type(field: Field, definition: Any) -> Any:
    value_type = _value_type(field, definition)
    if field.size is not None:
        return definition.Array(value_type, field.size)
    if not field.is_sequence:
        return value_type
    if field.maximum is None:
        return definition.UnboundedSequence(value_type)
    return definition.BoundedSequence(value_type, field.maximum)


def _value_type(field: Field, definition: Any) -> Any:
    match field.type:
        case Basic(name):
            return definition.BasicType(name)
        case Text(wide, maximum):
            kind = "WString" if wide else "String"
            if maximum is None:
                return getattr(definition, f"Unbounded{kind}")()
            return getattr(definition, f"Bounded{kind}")(maximum)
        case message_class:
            return definition.NamespacedType(message_class.__module__.split(".")[:2], message_class.__name__)
