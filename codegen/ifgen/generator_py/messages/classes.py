"""From a message (or a part of a service or action) to the text of its class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.generator_py.codec import plan_codec
from ifgen.generator_py.messages.context import ConstantText, EnumText, FieldText, MessageClass
from ifgen.generator_py.messages.docstrings import constant_documentation, docstring, field_documentation
from ifgen.generator_py.messages.enums import enums
from ifgen.generator_py.messages.facts import Facts
from ifgen.generator_py.messages.fields import Reference, default_literal, literal, python_field, rosidl_text
from ifgen.generator_py.names import attribute_name, class_reference, default_name, slot_name
from ifgen.generator_py.scope import Scope

_ALWAYS_USED = (
    *("Message", "MessageMeta", "checks_by_default", "initialize_checked", "new_object"),
    *("Any", "ClassVar", "Never", "bool", "dict", "int", "locals", "staticmethod", "str"),
)

# Each expression in an f-string costs Python 3.12 and 3.13 a copy of the rest of the file.
_MOST_F_STRINGS = 500


def taken_names(messages: Iterable[Message]) -> Iterator[str]:
    """What the classes of a module, their fields and constants are called."""
    for message in messages:
        yield message.name
        yield from (constant.name for constant in message.constants)
        for field in message.fields:
            yield attribute_name(field)
            yield default_name(field)
        yield from (enum.name for enum in enums(message))


def message_class(message: Message, title: str, facts: Facts, scope: Scope) -> MessageClass:
    """The class of a message; `title` is its docstring where the definition says nothing."""

    def reference(type_: NamespacedType) -> str:
        return reference_to(type_, message, scope)

    is_long = len(message.fields) > _MOST_F_STRINGS
    for name in (*_ALWAYS_USED, "repr_of_fields" if is_long else "repr_name"):
        scope(name)
    fields = tuple(_field_text(field, scope, reference) for field in message.fields)
    converts = any(field.python.converted for field in fields)
    for name in ("Exception", "note_field", "property") if converts else ():
        scope(name)
    codec = plan_codec(message, facts.extents)
    scope.add_codec_names(codec.runtime_imports)
    for type_ in codec.class_types:
        reference_to(type_, message, scope, only_codec=True)
    return MessageClass(
        name=message.name,
        type_name=message.type_name,
        type_hash=facts.hashes.of(message),
        docstring=docstring(message.documentation or title, indent=4),
        is_long=is_long,
        slots=_tuple(field.python.slot for field in fields),
        field_types=_dict((field.name, rosidl_text(field.type)) for field in message.fields),
        fields=fields,
        converts=converts,
        renamed=tuple((field.name, field.attribute) for field in fields if field.name != field.attribute),
        constants=tuple(_constants(message, scope)),
        lower_constants=_tuple(lower) if (lower := _lower_constants(message)) else "",
        defaults=tuple(_defaults(message, scope, reference)),
        enums=_enums(message, scope),
        codec=codec,
    )


def reference_to(type_: NamespacedType, home: Message, scope: Scope, *, only_codec: bool = False) -> str:
    """What the module of `home` calls a message class; imported if it is of another module."""
    reference = class_reference(type_, home)
    if reference != type_.name:
        scope.add_class(f"{type_.package}.{type_.folder}", type_.name, reference, only_codec=only_codec)
    return reference


def _field_text(field: Field, scope: Scope, reference: Reference) -> FieldText:
    python = python_field(field, scope, reference)
    return FieldText(
        name=field.name,
        attribute=attribute_name(field),
        private=slot_name(field),
        docstring=docstring(field_documentation(field), indent=8 if python.converted else 4),
        python=python,
    )


def _lower_constants(message: Message) -> tuple[str, ...]:
    return tuple(constant.name for constant in message.constants if not constant.name.isupper())


def _constants(message: Message, scope: Scope) -> Iterator[ConstantText]:
    for constant in message.constants:
        text = constant_documentation(constant)
        value = literal(constant.value, scope)
        yield ConstantText(constant.name, scope("Final"), value, docstring(text, indent=4) if text else "")


def _defaults(message: Message, scope: Scope, reference: Reference) -> Iterator[ConstantText]:
    for field in message.fields:
        if field.default_value is not None:
            value = default_literal(field, scope)
            if isinstance(field.type, Array | BoundedSequence | UnboundedSequence):
                value = f"{scope('mutable_default')}(lambda: {value})"
            annotation = python_field(field, scope, reference).annotation
            yield ConstantText(default_name(field), f"{scope('ClassVar')}[{annotation}]", value, "")


def _enums(message: Message, scope: Scope) -> tuple[EnumText, ...]:
    found = enums(message)
    if found:
        scope("IntEnum")
        scope("enum_view")
    return found


def _tuple(names: Iterable[str]) -> str:
    """A tuple of strings as ruff formats it at the level of a class body."""
    quoted = [f'"{name}"' for name in names]
    if len(quoted) < 2:
        return f"({''.join(quoted)}{',' * len(quoted)})"
    return "(\n" + "".join(f"        {name},\n" for name in quoted) + "    )"


def _dict(items: Iterable[tuple[str, str]]) -> str:
    """A dictionary of strings as ruff formats it at the level of a class body."""
    lines = [f'        "{key}": "{value}",\n' for key, value in items]
    return "{\n" + "".join(lines) + "    }" if lines else "{}"
