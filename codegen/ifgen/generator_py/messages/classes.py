"""From a message (or a part of a service or action) to the text of its class."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from ifgen.definition.interfaces import Constant, Field, Message, Registry
from ifgen.definition.meaning.reading import Reading, reading_of
from ifgen.definition.meaning.values import Meaning, words
from ifgen.definition.names import attribute_name, default_name
from ifgen.definition.spelling import spelled
from ifgen.definition.type_description import TypeHashes
from ifgen.definition.types import (
    COLLECTIONS,
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
    UnboundedSequence,
)
from ifgen.generator_py.codec.text import CodecText, render
from ifgen.generator_py.imports import IN_MESSAGES, Import, Scope
from ifgen.generator_py.messages.context import (
    ClassLines,
    ConstantText,
    FieldText,
    MessageClass,
    ViewsText,
    enums,
)
from ifgen.generator_py.messages.fields import Reference, default_literal, literal, python_field, rosidl_text
from ifgen.generator_py.names import class_reference, slot_name
from ifgen.generator_py.text import docstring
from ifgen.wire.plan import Extents, plan
from ifgen.wire.program import NUMBERS

# The classes of `ifgen_runtime.views`, by the dtype that their names spell in lower case.
_ARRAYS = {name.lower().removesuffix("array"): name for name in IN_MESSAGES if name.endswith("Array")}
# What mypy and pyright refuse otherwise: an array of numpy is no array.array.
_OTHER_TYPE = "  # type: ignore[assignment]"
_NARROWER = "  # pyright: ignore[reportIncompatibleVariableOverride]"
# Each expression in an f-string costs Python 3.12 and 3.13 a copy of the rest of the file.
_MOST_F_STRINGS = 500


class Facts:
    """Facts about the messages in a registry, besides their definitions."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.hashes = TypeHashes(registry)
        self.extents = Extents(registry)

    def codec(self, message: Message) -> CodecText:
        """The codec that the module of a message has."""
        return render(plan(message, self.extents, slot_name))

    def module_of(self, type_: NamespacedType) -> str:
        """The module that other modules import a message class from."""
        return f"{type_.package}.{type_.folder}"


def taken_names(messages: Iterable[Message]) -> Iterator[str]:
    """The names of a module's classes, their fields and constants."""
    for message in messages:
        yield message.name
        yield from (constant.name for constant in message.constants)
        for field in message.fields:
            yield attribute_name(field)
            yield default_name(field)
        yield from (enum.name for enum in enums(message))


def class_lines(scope: Scope) -> ClassLines:
    """The parts that every message class of a module shares."""
    any_, text = scope("Any"), scope("str")
    return ClassLines(
        metaclass=scope("MessageMeta"),
        base=scope("Message"),
        texts=f"{scope('ClassVar')}[{scope('dict')}[{text}, {text}]]",
        parameters=(f"check_fields: {scope('bool')} = _check_fields", f"**_unknown: {scope('NoSuchField')}"),
        checked=f"{scope('initialize_checked')}(self, {scope('locals')}())",
        repr=f"def __repr__(self) -> {text}:",
        equality=f"def __eq__(self: {any_}, other: {any_}) -> {scope('bool')}:",
        default=f"@{scope('staticmethod')}\n    def __default__() -> {any_}:",
        deepcopy=f"def __deepcopy__(self, memo: {scope('dict')}[{scope('int')}, {any_}]) -> {any_}:",
        untyped=f"message: {any_} = self",
        new=scope("new_object"),
    )


def message_class(
    message: Message, title: str, facts: Facts, scope: Scope, lines: ClassLines
) -> MessageClass:
    """The class of a message; `title` is its docstring where the definition says nothing."""

    def reference(type_: NamespacedType) -> str:
        return reference_to(type_, message, scope, facts)

    is_long = len(message.fields) > _MOST_F_STRINGS
    fields = tuple(_field_text(field, scope, reference) for field in message.fields)
    converts = any(field.python.converted for field in fields)
    codec = facts.codec(message)
    scope.add_for_codec(codec.runtime_imports, _imported(codec.class_types, message, facts))
    return MessageClass(
        name=message.name,
        type_name=message.type_name,
        type_hash=facts.hashes.of(message),
        docstring=docstring(message.documentation or title, indent=4),
        lines=lines,
        is_long=is_long,
        shown=f"{scope('repr_of_fields' if is_long else 'repr_name')}(self)",
        slots=_tuple(field.python.slot for field in fields),
        field_types=_dict((field.name, rosidl_text(field.type)) for field in message.fields),
        fields=fields,
        converts=converts,
        failed=_failed(scope, "self") if converts else "",
        renamed=tuple((field.name, field.attribute) for field in fields if field.name != field.attribute),
        constants=tuple(_constants(message, scope)),
        lower_constants=_tuple(lower) if (lower := _lower_constants(message)) else "",
        defaults=tuple(_defaults(message, fields, scope)),
        enums=enums(message, scope),
        views=views(message, facts, scope, reference),
        codec=codec,
    )


def reference_to(type_: NamespacedType, home: Message, scope: Scope, facts: Facts) -> str:
    """The name of a message class in the module of `home`; imported if it is from another module."""
    for import_ in _imported((type_,), home, facts):
        scope.add(*import_)
    return class_reference(type_, home)


def _imported(types: Iterable[NamespacedType], home: Message, facts: Facts) -> Iterator[Import]:
    """The imports of those classes that are not of the module of `home`."""
    for type_ in types:
        reference = class_reference(type_, home)
        if reference != type_.name:
            yield facts.module_of(type_), type_.name, reference


def _field_text(field: Field, scope: Scope, reference: Reference) -> FieldText:
    attribute = attribute_name(field)
    python = python_field(field, attribute, scope, reference)
    found = reading_of(field)
    annotation = annotated(python.annotation, found.meaning, scope) if found.meaning else python.annotation
    getter = failed = ""
    if python.converted:
        getter = f"@{scope('property')}\n    def {attribute}(self) -> {annotation}:"
        failed = _failed(scope, f'self, "{attribute}"')
    return FieldText(
        name=field.name,
        attribute=attribute,
        private=f"_{attribute}",
        annotation=annotation,
        docstring=docstring(_field_documentation(field, found), indent=8 if python.converted else 4),
        getter=getter,
        failed=failed,
        python=python,
    )


def _failed(scope: Scope, arguments: str) -> str:
    """The statement of a method for a field that cannot convert its value."""
    noted = f"{scope('note_field')}({arguments})"
    return f"except {scope('Exception')}:\n            {noted}\n            raise"


def _lower_constants(message: Message) -> tuple[str, ...]:
    return tuple(constant.name for constant in message.constants if not constant.name.isupper())


def _constants(message: Message, scope: Scope) -> Iterator[ConstantText]:
    for constant in message.constants:
        text = _constant_documentation(constant)
        value = literal(constant.value, scope)
        yield ConstantText(constant.name, scope("Final"), value, docstring(text, indent=4) if text else "")


def _defaults(message: Message, fields: Iterable[FieldText], scope: Scope) -> Iterator[ConstantText]:
    for field, text in zip(message.fields, fields, strict=True):
        if field.default_value is not None:
            value = default_literal(field, scope)
            if isinstance(field.type, COLLECTIONS):
                value = f"{scope('mutable_default')}(lambda: {value})"
            annotation = f"{scope('ClassVar')}[{text.python.annotation}]"
            yield ConstantText(default_name(field), annotation, value, "")


def annotated(annotation: str, meaning: Meaning, scope: Scope) -> str:
    """A type with the meaning of its field, as `ifgen_runtime.meaning` has it."""
    markers = ", ".join(f"{scope('meaning')}.{marker}" for marker in _markers(meaning))
    return f"{scope('Annotated')}[{annotation}, {markers}]"


def _markers(meaning: Meaning) -> Iterator[str]:
    if meaning.unit:
        yield f"Unit({_text(meaning.unit)})"
    if meaning.range:
        bounds = {"minimum": meaning.range.minimum, "maximum": meaning.range.maximum}
        yield f"Range({', '.join(f'{name}={value}' for name, value in bounds.items() if value is not None)})"
    if meaning.enum:
        yield f"Constants({', '.join(map(_text, meaning.enum))})"
    if meaning.frame:
        yield f"Frame({_text(meaning.frame)})"
    if meaning.invalid:
        value = "" if meaning.invalid.spelled == "NaN" else f"value={meaning.invalid.spelled}"
        when = f"when={_text(meaning.invalid.when)}" if meaning.invalid.when else ""
        yield f"Invalid({', '.join(filter(None, (value, when)))})"
    if meaning.deprecated is not None:
        yield f"Deprecated({_text(meaning.deprecated) if meaning.deprecated else ''})"


def _text(text: str) -> str:
    """A text as a literal that ruff leaves alone; no line of a comment has a line break in it."""
    return json.dumps(text, ensure_ascii=not text.isprintable())


def _field_documentation(field: Field, found: Reading) -> str:
    """The definition's comment on a field, and a last line with its type (bounds included) and meaning."""
    last = ", ".join(filter(None, (f"`{spelled(field.type)}`", words(found.meaning))))
    return f"{found.text}\n\n{last}." if found.text else f"{last}."


def _constant_documentation(constant: Constant) -> str:
    """The definition's comment on a constant, and a last line with its unit if it has one."""
    found = reading_of(constant)
    meaning = words(found.meaning)
    last = f"{meaning[0].upper()}{meaning[1:]}." if meaning else ""
    return "\n\n".join(filter(None, (found.text, last)))


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


def views(message: Message, facts: Facts, scope: Scope, reference: Reference) -> ViewsText | None:
    """The class for messages with views; None if the message has no sequences of numbers to view."""
    if not facts.extents.of(message).has_sequences:
        return None
    name = f"_{message.name}Views"
    return ViewsText(
        name=name,
        alias=f'{_views_alias(message)}: {scope("TypeAlias")} = "{name}"',
        method=f"@{scope('classmethod')}\n        def __views__(cls) -> {name}: ...",
        fields=tuple(_view_fields(message, facts, scope, reference)),
    )


def _view_fields(message: Message, facts: Facts, scope: Scope, reference: Reference) -> Iterator[str]:
    """The fields that have another type."""

    def viewed(type_: NamespacedType) -> str | None:
        nested = facts.registry.message(type_.type_name)
        return (
            f"{reference(type_)}.{_views_alias(nested)}" if facts.extents.of(nested).has_sequences else None
        )

    for field in message.fields:
        match field.type:
            case BoundedSequence(BasicType(name), _) | UnboundedSequence(BasicType(name)):
                if NUMBERS[name].typecode:
                    yield f"{attribute_name(field)}: {scope(_ARRAYS[NUMBERS[name].dtype])}{_OTHER_TYPE}"
            case NamespacedType() as type_:
                if nested := viewed(type_):
                    yield f"{attribute_name(field)}: {nested}{_NARROWER}"
            case (
                Array(NamespacedType() as type_, _)
                | BoundedSequence(NamespacedType() as type_, _)
                | UnboundedSequence(NamespacedType() as type_)
            ):
                if nested := viewed(type_):
                    yield f"{attribute_name(field)}: {scope('list')}[{nested}]{_OTHER_TYPE}"
            case _:
                pass


def _views_alias(message: Message) -> str:
    """The attribute of a message class that is this class, unless something else has the name."""
    taken = {*map(attribute_name, message.fields), *(constant.name for constant in message.constants)}
    taken.update(enum.name for enum in enums(message))
    return "Views_" if "Views" in taken else "Views"
