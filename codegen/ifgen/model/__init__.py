"""The model that generators of every language get: interfaces, types, their bytes, and nodes.

It is public, and stable: docs/model.md says what is in it, and how it may change. Its dataclasses are what
templates of outputs see, and `document` is the same as JSON.
"""

from ifgen.model.document import SCHEMA, VERSION, document, plain, read, schema, to_text
from ifgen.model.interfaces import (
    Annotation,
    Array,
    Constant,
    Field,
    FieldType,
    Interface,
    Invalid,
    Meaning,
    Message,
    Model,
    Package,
    Position,
    Range,
    Service,
    TypeReference,
    Value,
)
from ifgen.model.names import LANGUAGES, RESERVED, safe_name
from ifgen.model.nodes import Endpoint, Node, Parameter, Qos, Timer
from ifgen.model.wire import Item, Primitive, Step, Wire

__all__ = [
    "LANGUAGES",
    "RESERVED",
    "SCHEMA",
    "VERSION",
    "Annotation",
    "Array",
    "Constant",
    "Endpoint",
    "Field",
    "FieldType",
    "Interface",
    "Invalid",
    "Item",
    "Meaning",
    "Message",
    "Model",
    "Node",
    "Package",
    "Parameter",
    "Position",
    "Primitive",
    "Qos",
    "Range",
    "Service",
    "Step",
    "Timer",
    "TypeReference",
    "Value",
    "Wire",
    "document",
    "plain",
    "read",
    "safe_name",
    "schema",
    "to_text",
]
