"""The class of a message with views as type checkers see it: sequences of numbers are arrays of numpy.

A message that `deserialize(..., views=True)` returns is an object of the ordinary class. Type checkers see a
derived one, `Image.Views`, whose sequences have other types. It exists for them only.
"""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.definition.interfaces import Message
from ifgen.definition.types import Array, BasicType, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.generator_py.codec.program import NUMBERS
from ifgen.generator_py.messages.context import ViewsText
from ifgen.generator_py.messages.enums import enums
from ifgen.generator_py.messages.facts import Facts
from ifgen.generator_py.messages.fields import Reference
from ifgen.generator_py.messages.scope import Scope
from ifgen.generator_py.names import attribute_name

_ARRAYS = {
    "int8": "Int8Array",
    "uint8": "UInt8Array",
    "int16": "Int16Array",
    "uint16": "UInt16Array",
    "int32": "Int32Array",
    "uint32": "UInt32Array",
    "int64": "Int64Array",
    "uint64": "UInt64Array",
    "float32": "Float32Array",
    "float64": "Float64Array",
}
"""The names in `ifgen_runtime.views`, by dtype."""

# What mypy and pyright refuse otherwise: an array of numpy is no array.array.
_OTHER_TYPE = "  # type: ignore[assignment]"
_NARROWER = "  # pyright: ignore[reportIncompatibleVariableOverride]"


def views(message: Message, facts: Facts, scope: Scope, reference: Reference) -> ViewsText | None:
    """The class for messages with views; None if the message has no sequences of numbers to view."""
    if not facts.extents.of(message).has_sequences:
        return None
    name = f"_{message.name}Views"
    return ViewsText(
        name=name,
        alias=f'{_alias(message)}: {scope("TypeAlias")} = "{name}"',
        method=f"@{scope('classmethod')}\n        def __views__(cls) -> {name}: ...",
        fields=tuple(_fields(message, facts, scope, reference)),
    )


def _fields(message: Message, facts: Facts, scope: Scope, reference: Reference) -> Iterator[str]:
    """The fields that have another type."""

    def viewed(type_: NamespacedType) -> str | None:
        nested = facts.registry.message(type_.type_name)
        return f"{reference(type_)}.{_alias(nested)}" if facts.extents.of(nested).has_sequences else None

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


def _alias(message: Message) -> str:
    """The attribute of a message class that is this class, unless something else has the name."""
    taken = {*map(attribute_name, message.fields), *(constant.name for constant in message.constants)}
    taken.update(enum.name for enum in enums(message))
    return "Views_" if "Views" in taken else "Views"
