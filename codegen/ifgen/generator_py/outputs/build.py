"""From interfaces and nodes to their views, which templates of the user's own see."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final, assert_never

from ifgen.definition.interfaces import (
    Action,
    Annotation,
    Constant,
    Field,
    Interface,
    Message,
    Registry,
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
    UnboundedSequence,
    ValueType,
    element_of,
)
from ifgen.generator_py.messages.fields import zero_literal
from ifgen.generator_py.names import interface_name
from ifgen.generator_py.outputs.view import (
    AnnotationView,
    Base,
    ConstantView,
    EndpointView,
    FieldView,
    InterfaceView,
    Kind,
    MessageName,
    MessageView,
    NodeView,
    ParameterView,
    QosView,
    Role,
    TimerView,
    TypeView,
)
from ifgen.generator_py.text import plain_literal
from ifgen.nodl.model import (
    Endpoint,
    NodeDescription,
    Parameter,
    QosProfile,
    Timer,
    Validator,
)
from ifgen.nodl.names import expanded
from ifgen.nodl.values import spelled as spelled_type
from ifgen.nodl.yaml_lines import yaml_value

_BASES: Final[Mapping[str, Base]] = {
    "boolean": "bool",
    "octet": "byte",
    "char": "char",
    "float": "float",
    "double": "float",
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
        python_value=plain_literal(constant.value),
        documentation=constant.documentation,
        unit=constant.unit,
        annotations=_annotations(constant.annotations),
    )


def _field(field: Field) -> FieldView:
    return FieldView(
        name=field.name,
        attribute=attribute_name(field),
        type=_type(field.type),
        default=None if field.default_value is None else spelled_value(field.default_value),
        python_default=_python_default(field),
        documentation=field.documentation,
        unit=field.unit,
        annotations=_annotations(field.annotations),
    )


def _python_default(field: Field) -> str | None:
    value = field.default_value
    if isinstance(value, tuple):
        return f"[{', '.join(map(plain_literal, value))}]"
    if value is not None:
        return plain_literal(value)
    if isinstance(field.type, BoundedSequence | UnboundedSequence):
        return "[]"
    zero = zero_literal(element_of(field.type))
    return f"[{zero}] * {field.type.size}" if isinstance(field.type, Array) and zero else zero


def _type(type_: FieldType) -> TypeView:
    many = isinstance(type_, CollectionType)
    element = element_of(type_)
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
    if isinstance(element, NamespacedType):
        return "message"
    return _BASES.get(element.typename, "int") if isinstance(element, BasicType) else "string"


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


def node_view(node: NodeDescription) -> NodeView:
    """The view of a node for templates."""

    def views(endpoints: tuple[Endpoint, ...]) -> tuple[EndpointView, ...]:
        return tuple(_endpoint(endpoint, node.name) for endpoint in endpoints)

    return NodeView(
        package=node.package,
        name=node.name,
        node_class=node.node_class,
        style=node.style,
        documentation=node.description,
        parameters=tuple(map(_parameter, node.parameters)),
        endpoints=views(node.endpoints),
        publishers=views(node.publishers),
        subscriptions=views(node.subscriptions),
        service_servers=views(node.service_servers),
        service_clients=views(node.service_clients),
        action_servers=views(node.action_servers),
        action_clients=views(node.action_clients),
        timers=tuple(map(_timer, node.timers)),
    )


def _endpoint(endpoint: Endpoint, node: str) -> EndpointView:
    return EndpointView(
        category=endpoint.category.value,
        name=endpoint.name,
        full_name=expanded(endpoint.name, node),
        type_name=endpoint.type_name,
        documentation=endpoint.description,
        qos=None if endpoint.qos is None else _qos(endpoint.qos),
    )


def _qos(qos: QosProfile) -> QosView:
    return QosView(
        history=qos.history,
        depth=qos.depth or None,
        reliability=qos.reliability,
        durability=qos.durability,
        deadline=_seconds(qos.deadline_ns),
        lifespan=_seconds(qos.lifespan_ns),
        liveliness=qos.liveliness,
        liveliness_lease_duration=_seconds(qos.liveliness_lease_duration_ns),
    )


def _seconds(nanoseconds: int) -> float | None:
    return nanoseconds / 1e9 if nanoseconds else None


def _parameter(parameter: Parameter) -> ParameterView:
    constraints = [_constraint(validator) for validator in parameter.validators]
    if parameter.additional_constraints:
        constraints.append(parameter.additional_constraints)
    return ParameterView(
        name=parameter.name,
        type=spelled_type(parameter.type),
        default=None if parameter.default is None else yaml_value(parameter.default),
        documentation=parameter.description,
        read_only=parameter.read_only,
        constraints=tuple(constraints),
    )


def _constraint(validator: Validator) -> str:
    return f"{validator.name}<>: {yaml_value(validator.arguments)}"


def _timer(timer: Timer) -> TimerView:
    return TimerView(
        name=timer.name,
        period=timer.period,
        period_parameter=timer.period_parameter,
        publishes=timer.publishes,
    )
