"""From interfaces to what templates of the user's own see of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import assert_never

from ifgen.definition.interfaces import (
    Action,
    Annotation,
    Constant,
    Field,
    Interface,
    Message,
    Registry,
    Scalar,
    Service,
)
from ifgen.definition.literals import INTEGER_RANGES
from ifgen.definition.names import attribute_name, snake_case
from ifgen.definition.references import references
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.type_description import type_hash
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    NamespacedType,
    ValueType,
)
from ifgen.generator_py.names import interface_name
from ifgen.generator_py.outputs.view import (
    AnnotationView,
    Base,
    ConstantView,
    FieldView,
    InterfaceView,
    Kind,
    MessageName,
    MessageView,
    Role,
    TypeView,
)

_ZERO = {
    "bool": "False",
    "int": "0",
    "float": "0.0",
    "byte": repr(bytes(1)),
    "char": repr(chr(0)),
    "string": '""',
}


def interface_view(interface: Interface, registry: Registry) -> InterfaceView:
    """The view of an interface for templates."""
    kind, parts = _parts(interface)
    return InterfaceView(
        kind=kind,
        package=interface.package,
        folder=interface.folder,
        name=interface.name,
        snake_name=snake_case(interface.name),
        type_name=interface.type_name,
        type_hash=type_hash(interface, registry),
        module=f"{interface.package}.{interface.folder}",
        documentation=interface.documentation,
        messages=tuple(_message(part, role) for role, part in parts),
        uses=tuple(_uses(part for _, part in parts)),
        source=interface.source.text if interface.source else "",
    )


def _parts(interface: Interface) -> tuple[Kind, tuple[tuple[Role, Message], ...]]:
    match interface:
        case Message():
            return "message", (("message", interface),)
        case Service(request=request, response=response):
            return "service", (("request", request), ("response", response))
        case Action(goal=goal, result=result, feedback=feedback):
            return "action", (("goal", goal), ("result", result), ("feedback", feedback))
        case _:
            assert_never(interface)


def _message(message: Message, role: Role) -> MessageView:
    return MessageView(
        name=message.name,
        type_name=message.type_name,
        role=role,
        documentation=message.documentation,
        constants=tuple(map(_constant, message.constants)),
        fields=tuple(map(_field, message.fields)),
        annotations=_annotations(message.annotations),
    )


def _annotations(annotations: Iterable[Annotation]) -> tuple[AnnotationView, ...]:
    return tuple(AnnotationView(a.name, a.value, dict(a.parameters)) for a in annotations)


def _constant(constant: Constant) -> ConstantView:
    return ConstantView(
        name=constant.name,
        type=_type(constant.type),
        value=spelled_value(constant.value),
        python_value=_literal(constant.value),
        documentation=constant.documentation,
        unit=constant.unit,
        annotations=_annotations(constant.annotations),
    )


def _field(field: Field) -> FieldView:
    type_ = _type(field.type)
    return FieldView(
        name=field.name,
        attribute=attribute_name(field),
        type=type_,
        default=None if field.default_value is None else spelled_value(field.default_value),
        python_default=_python_default(field.default_value, type_),
        documentation=field.documentation,
        unit=field.unit,
        annotations=_annotations(field.annotations),
    )


def _python_default(value: Scalar | tuple[Scalar, ...] | None, type_: TypeView) -> str | None:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_literal, value))}]"
    if value is not None:
        return _literal(value)
    if type_.many and type_.size is None:
        return "[]"
    zero = _ZERO.get(type_.base)
    return f"[{zero}] * {type_.size}" if type_.many and zero else zero


def _literal(value: Scalar) -> str:
    if isinstance(value, float) and value - value != 0.0:  # inf or nan
        return f'float("{value}")'
    return repr(value)


def _type(type_: FieldType) -> TypeView:
    many = isinstance(type_, CollectionType)
    element = type_.value_type if isinstance(type_, CollectionType) else type_
    base = _base(element)
    low = high = None
    if base == "int" and isinstance(element, BasicType):
        low, high = INTEGER_RANGES[element.typename]
    return TypeView(
        text=spelled(type_),
        element=spelled(element),
        base=base,
        message=_message_name(element) if isinstance(element, NamespacedType) else None,
        many=many,
        size=type_.size if isinstance(type_, Array) else None,
        maximum_size=type_.maximum_size if isinstance(type_, BoundedSequence) else None,
        minimum=low,
        maximum=high,
        maximum_length=element.maximum_size if isinstance(element, BoundedString | BoundedWString) else None,
    )


def _base(element: ValueType) -> Base:
    match element:
        case NamespacedType():
            return "message"
        case BasicType("boolean"):
            return "bool"
        case BasicType("octet"):
            return "byte"
        case BasicType("char"):
            return "char"
        case BasicType("float" | "double"):
            return "float"
        case BasicType():
            return "int"
        case _:
            return "string"


def _uses(parts: Iterable[Message]) -> Iterator[MessageName]:
    seen: set[str] = set()
    for part in parts:
        seen.add(part.type_name)
        for _, type_ in references(part):
            if type_.type_name not in seen:
                seen.add(type_.type_name)
                yield _message_name(type_)


def _message_name(type_: NamespacedType) -> MessageName:
    return MessageName(
        type_name=type_.type_name,
        package=type_.package,
        folder=type_.folder,
        name=type_.name,
        interface=interface_name(type_),
        snake_interface=snake_case(interface_name(type_)),
        module=f"{type_.package}.{type_.folder}",
    )
