"""From resolved interfaces to `ifgen.model`."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final, assert_never

from ifgen import model, resources
from ifgen.definition.interfaces import (
    Action,
    Annotation,
    Constant,
    Field,
    Interface,
    InterfacePackage,
    Message,
    Registry,
    Scalar,
    Service,
)
from ifgen.definition.literals import INTEGER_RANGES
from ifgen.definition.meaning.reading import deprecation_of, is_closed, named_constants, reading_of
from ifgen.definition.meaning.units import normal
from ifgen.definition.meaning.values import Meaning, words
from ifgen.definition.names import snake_case
from ifgen.definition.references import references
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.type_description import Described, TypeHashes, describe, type_id
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
    UnboundedWString,
    ValueType,
    element_of,
)
from ifgen.diagnostics import Span
from ifgen.generator_py.messages import context
from ifgen.generator_py.messages.fields import zero_literal
from ifgen.generator_py.names import interface_name
from ifgen.generator_py.outputs.wire import PRIMITIVES, Wires
from ifgen.generator_py.text import plain_literal
from ifgen.model.interfaces import ArrayKind, Kind, MessageKind
from ifgen.model.names import safe_names
from ifgen.reading.packages import IDL
from ifgen.wire.plan import Extents
from ifgen.wire.program import NUMBERS

_SEPARATOR: Final = "=" * 80
_FLOATS: Final = {"float": ("<f", "<I", 8), "double": ("<d", "<Q", 16)}


class ModelBuilder:
    """Builds the model of registries; what two of them have comes from the first.

    `spans` are the places of elements, by their ids, for diagnostics about them.
    """

    def __init__(self, registries: Sequence[Registry], is_generated: Callable[[str], bool]) -> None:
        """`is_generated` says which interfaces are asked for, by their type names."""
        self._registries = registries
        self._is_generated = is_generated
        self.spans: dict[str, Span] = {}
        self._messages: dict[str, model.Message] = {}
        self._wires = Wires()

    def build(
        self, packages: Iterable[str] = (), nodes: Mapping[str, tuple[model.Node, ...]] | None = None
    ) -> model.Model:
        """The model of everything; `packages` are generated, the others only needed."""
        nodes = nodes or {}
        found: dict[str, model.Package] = {}
        generated = set(packages)
        for registry in self._registries:
            builder = _Builder(registry, self._is_generated, self.spans, self._messages, self._wires)
            for package in registry.packages.values():
                if package.name not in found or not found[package.name].interfaces:
                    found[package.name] = self._package(builder, package, nodes, generated)
        for name in nodes.keys() - found.keys():
            found[name] = model.Package(name, (), nodes[name], name in generated)
        return model.Model(
            model=model.VERSION,
            ifgen=resources.VERSION,
            packages=tuple(found[name] for name in sorted(found)),
            types=tuple(self._messages.values()),
        )

    @staticmethod
    def _package(
        builder: _Builder,
        package: InterfacePackage,
        nodes: Mapping[str, tuple[model.Node, ...]],
        generated: set[str],
    ) -> model.Package:
        interfaces = tuple(map(builder.interface, package.interfaces))
        return model.Package(package.name, interfaces, nodes.get(package.name, ()), package.name in generated)


def interface_model(interface: Interface, registry: Registry) -> model.Interface:
    """One interface as generators see it."""
    builder = _Builder(registry, lambda name: name == interface.type_name, {}, {}, Wires())
    return builder.interface(interface)


class _Builder:
    """Builds the interfaces of one registry. `messages` grows by each message, after those that it needs."""

    def __init__(
        self,
        registry: Registry,
        is_generated: Callable[[str], bool],
        spans: dict[str, Span],
        messages: dict[str, model.Message],
        wires: Wires,
    ) -> None:
        self._registry = registry
        self._is_generated = is_generated
        self._spans = spans
        self._messages = messages
        self._hashes = TypeHashes(registry)
        self._extents = Extents(registry)
        self._wires = wires
        self._owners: dict[str, tuple[Interface, MessageKind]] = {}
        for interface in registry:
            for kind, part in _parts(interface):
                self._owners[part.type_name] = interface, kind

    def interface(self, interface: Interface) -> model.Interface:
        parts = dict(_parts(interface))
        types = {part.type_name: self._message(part) for part in parts.values()}
        kind, own = _own(interface)
        messages = tuple(types[parts[role].type_name] for role in own)
        self._place(interface.type_name, interface.span)
        source = interface.source
        return model.Interface(
            id=interface.type_name,
            kind=kind,
            package=interface.package,
            folder=interface.folder,
            name=interface.name,
            snake_name=snake_case(interface.name),
            type_name=interface.type_name,
            type_hash=self._hashes.of(interface),
            generate=self._is_generated(interface.type_name),
            documentation=interface.documentation,
            messages=messages,
            types=tuple(types.values()),
            services=tuple(map(self._service, _services(interface))),
            uses=tuple(_uses(parts[role] for role in own)),
            file=f"{interface.folder}/{source.path.name}" if source else "",
            source=source.text if source else "",
            full_definition=self._full_definition(interface),
            names=safe_names(interface.name),
            position=_position(interface.span),
            description=describe(interface, self._registry),
            meanings=model.Meaning(),
        )

    def _service(self, service: Service) -> model.Service:
        return model.Service(
            type_name=service.type_name,
            name=service.name,
            type_hash=self._hashes.of(service),
            request=service.request.type_name,
            response=service.response.type_name,
            event=service.event.type_name,
            description=describe(service, self._registry),
        )

    def _full_definition(self, interface: Interface) -> str:
        kinds, parts = _own(interface)[1], dict(_parts(interface))
        needed: dict[str, Described] = {interface.type_name: interface}
        for kind in kinds:
            needed |= {message.type_name: message for message in self._hashes.referenced(parts[kind])}
        first, *others = needed.values()
        texts = [_definition(first)]
        for message in sorted(others, key=lambda of: of.type_name):
            texts.append(f"{_SEPARATOR}\nMSG: {message.package}/{message.name}\n{_definition(message)}")
        return "".join(texts)

    def _message(self, message: Message) -> model.Message:
        """The message; first those that it needs. With a stack of our own, since chains may be long."""
        pending = [message]
        while pending:
            current = pending[-1]
            needed = (type_.type_name for _, type_ in references(current))
            missing = [name for name in dict.fromkeys(needed) if name not in self._messages]
            if missing:
                pending += map(self._registry.message, reversed(missing))
            else:
                pending.pop()
                if current.type_name not in self._messages:
                    self._messages[current.type_name] = self._built(current)
        return self._messages[message.type_name]

    def _built(self, message: Message) -> model.Message:
        owner, kind = self._owners[message.type_name]
        self._place(message.type_name, message.span)
        owned = {field.name: constants for field, constants in context.values(message)}
        return model.Message(
            id=message.type_name,
            type_name=message.type_name,
            kind=kind,
            package=message.package,
            folder=message.folder,
            name=message.name,
            snake_name=snake_case(message.name),
            interface=owner.type_name,
            generate=self._is_generated(owner.type_name),
            type_hash=self._hashes.of(message),
            documentation=message.documentation,
            dependencies=tuple(dict.fromkeys(type_.type_name for _, type_ in references(message))),
            fields=tuple(self._field(field, message, owned.get(field.name, ())) for field in message.fields),
            constants=tuple(self._constant(constant, message) for constant in message.constants),
            annotations=_annotations(message.annotations),
            placeholder=not message.fields,
            names=safe_names(message.name),
            position=_position(message.span),
            wire=self._wires.of(message, self._extents),
            description=describe(message, self._registry),
            meanings=model.Meaning(deprecated=deprecation_of(message)),
        )

    def _constant(self, constant: Constant, message: Message) -> model.Constant:
        id_ = f"{message.type_name}#{constant.name}"
        self._place(id_, constant.span)
        found = reading_of(constant)
        return model.Constant(
            id=id_,
            name=constant.name,
            type=_type(constant.type),
            value=spelled_value(constant.value),
            exact_value=_value(constant.value, constant.type),
            python_value=plain_literal(constant.value),
            documentation=found.text,
            unit=found.meaning.unit,
            annotations=_annotations(constant.annotations),
            names=safe_names(constant.name),
            position=_position(constant.span),
            meanings=_meaning(found.meaning),
        )

    def _field(self, field: Field, message: Message, constants: Sequence[Constant]) -> model.Field:
        id_ = f"{message.type_name}.{field.name}"
        self._place(id_, field.span)
        found = reading_of(field)
        default, element = field.default_value, element_of(field.type)
        elements = default if isinstance(default, tuple) else None
        single = None if isinstance(default, tuple) else default
        return model.Field(
            id=id_,
            name=field.name,
            type=_type(field.type),
            default=None if default is None else spelled_value(default),
            default_value=None if single is None else _value(single, element),
            default_elements=None if elements is None else tuple(_value(each, element) for each in elements),
            python_default=_python_default(field),
            documentation=found.text,
            unit=found.meaning.unit,
            annotations=_annotations(field.annotations),
            constants=tuple(constant.name for constant in constants),
            names=safe_names(field.name),
            position=_position(field.span),
            meanings=_meaning(found.meaning, named_constants(field, message), is_closed(field)),
        )

    def _place(self, id_: str, span: Span | None) -> None:
        if span is not None:
            self._spans.setdefault(id_, span)


def _parts(interface: Interface) -> tuple[tuple[MessageKind, Message], ...]:
    match interface:
        case Message():
            return (("message", interface),)
        case Service():
            return (
                ("request", interface.request),
                ("response", interface.response),
                ("event", interface.event),
            )
        case Action(send_goal=send_goal, get_result=get_result):
            return (
                ("goal", interface.goal),
                ("result", interface.result),
                ("feedback", interface.feedback),
                ("send_goal_request", send_goal.request),
                ("send_goal_response", send_goal.response),
                ("send_goal_event", send_goal.event),
                ("get_result_request", get_result.request),
                ("get_result_response", get_result.response),
                ("get_result_event", get_result.event),
                ("feedback_message", interface.feedback_message),
            )
        case _:
            assert_never(interface)


def _own(interface: Interface) -> tuple[Kind, tuple[MessageKind, ...]]:
    """The kind of an interface, and those of its parts that stand in its file."""
    match interface:
        case Message():
            return "message", ("message",)
        case Service():
            return "service", ("request", "response")
        case Action():
            return "action", ("goal", "result", "feedback")
        case _:
            assert_never(interface)


def _services(interface: Interface) -> tuple[Service, ...]:
    match interface:
        case Message():
            return ()
        case Service():
            return (interface,)
        case Action():
            return interface.send_goal, interface.get_result
        case _:
            assert_never(interface)


def _definition(described: Described) -> str:
    """The text of a file, as .msg, .srv or .action: what was read from an .idl file is written again."""
    source = described.source
    if source is not None and source.path.suffix != IDL:
        return source.text if source.text.endswith("\n") or not source.text else f"{source.text}\n"
    match described:
        case Message():
            parts: tuple[Message, ...] = (described,)
        case Service():
            parts = described.request, described.response
        case Action():
            parts = described.goal, described.result, described.feedback
    return "---\n".join("".join(_lines(part)) for part in parts)


def _lines(message: Message) -> Iterator[str]:
    for constant in message.constants:
        yield f"{_spelled(constant.type)} {constant.name}={spelled_value(constant.value)}\n"
    for field in message.fields:
        default = "" if field.default_value is None else f" {spelled_value(field.default_value)}"
        yield f"{_spelled(field.type)} {field.name}{default}\n"


def _spelled(type_: FieldType) -> str:
    """A type in a .msg file, whose `char` is a number."""
    return re.sub(r"^char\b", "uint8", spelled(type_))


def _position(span: Span | None) -> model.Position | None:
    return None if span is None else model.Position(*span.source.position(span.start))


def _meaning(meaning: Meaning, constants: Sequence[Constant] = (), closed: bool = False) -> model.Meaning:
    range_, invalid = meaning.range, meaning.invalid
    return model.Meaning(
        unit=meaning.unit,
        normal_unit=normal(meaning.unit) if meaning.unit else None,
        range=model.Range(range_.minimum, range_.maximum) if range_ else None,
        enum=tuple(constant.name for constant in constants),
        closed=closed and bool(constants),
        frame=meaning.frame,
        invalid=model.Invalid("nan" if math.isnan(invalid.value) else invalid.value, invalid.when)
        if invalid
        else None,
        deprecated=meaning.deprecated,
        summary=words(replace(meaning, unit=None)),
    )


def _annotations(annotations: Iterable[Annotation]) -> tuple[model.Annotation, ...]:
    return tuple(model.Annotation(a.name, a.value, dict(a.parameters)) for a in annotations)


def _value(value: Scalar, type_: ValueType) -> model.Value:
    name = type_.typename if isinstance(type_, BasicType) else ""
    match value:
        case bool():
            return model.Value(value, "true" if value else "false", None)
        case bytes():
            return model.Value(value[0], str(value[0]), None)
        case int() | float() if name in _FLOATS:
            return _float(float(value), *_FLOATS[name])
        case str() if name == "char":
            return model.Value(ord(value), str(ord(value)), None)
        case _:
            return model.Value(value, str(value), None)


def _float(value: float, form: str, word: str, digits: int) -> model.Value:
    data = _packed(form, value)
    [bits] = struct.unpack(word, data)
    exact = repr(value)
    if form == "<f":  # as few digits as will do for 32 bits
        texts = (f"{value:.{places}g}" for places in range(1, 10))
        exact = repr(float(next((text for text in texts if _packed(form, float(text)) == data), exact)))
        exact = exact if math.isfinite(struct.unpack(form, data)[0]) else repr(struct.unpack(form, data)[0])
    return model.Value(float(exact), exact, f"0x{bits:0{digits}x}")


def _packed(form: str, value: float) -> bytes:
    try:
        return struct.pack(form, value)
    except OverflowError:  # it is infinite in 32 bits
        return struct.pack(form, math.copysign(math.inf, value))


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


def _type(type_: FieldType) -> model.FieldType:
    element = element_of(type_)
    low = high = bits = None
    match element:
        case BasicType(name):
            primitive = PRIMITIVES[name]
            bits = NUMBERS[name].size * 8
            if primitive.startswith(("int", "uint")):
                low, high = INTEGER_RANGES[name]
        case NamespacedType():
            primitive = "message"
        case BoundedWString() | UnboundedWString():
            primitive = "wstring"
        case _:
            primitive = "string"
    return model.FieldType(
        primitive=primitive,
        bits=bits,
        array=_array(type_) if isinstance(type_, CollectionType) else None,
        string_bound=element.maximum_size if isinstance(element, BoundedString | BoundedWString) else None,
        message=_reference(element) if isinstance(element, NamespacedType) else None,
        minimum=low,
        maximum=high,
        type_id=type_id(type_),
        text=spelled(type_),
        element=spelled(element),
    )


def _array(type_: CollectionType) -> model.Array:
    kind: ArrayKind
    size: int | None
    match type_:
        case Array(size=size):
            kind = "fixed"
        case BoundedSequence(maximum_size=size):
            kind = "bounded"
        case UnboundedSequence():
            kind, size = "unbounded", None
    return model.Array(kind, size)


def _uses(parts: Iterable[Message]) -> Iterator[model.TypeReference]:
    seen: set[str] = set()
    for part in parts:
        seen.add(part.type_name)
        for _, type_ in references(part):
            if type_.type_name not in seen:
                seen.add(type_.type_name)
                yield _reference(type_)


def _reference(type_: NamespacedType) -> model.TypeReference:
    return model.TypeReference(
        type_name=type_.type_name,
        package=type_.package,
        folder=type_.folder,
        name=type_.name,
        interface=interface_name(type_),
        snake_interface=snake_case(interface_name(type_)),
    )
