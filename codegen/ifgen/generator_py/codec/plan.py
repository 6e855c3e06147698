"""From a message to the text of its codec."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ifgen.definition.interfaces import Message
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.generator_py.codec.decode import Decoder
from ifgen.generator_py.codec.encode import Encoder
from ifgen.generator_py.codec.extent import Extents
from ifgen.generator_py.codec.layout import Messages, Nested, Step, steps_of
from ifgen.generator_py.codec.text import Constants, wrapped
from ifgen.generator_py.names import class_reference


@dataclass(frozen=True, slots=True)
class CodecText:
    """The codec of one class, to be placed after the classes of its module.

    Import `runtime_imports` from `ifgen_runtime.codec`, and the classes of `class_types` from other modules
    under the names that `class_reference` returns. Then come the `constants` (assignments at module level),
    the functions `serialize` and `deserialize` (whole text without annotations, named
    `_serialize_<ClassName>` and `_deserialize_<ClassName>`, after the functions that they call), and last the
    statements `attachment`, which attach them to the class.
    """

    runtime_imports: tuple[str, ...]
    class_types: tuple[NamespacedType, ...]
    constants: tuple[str, ...]
    serialize: str
    deserialize: str
    attachment: str


def plan_codec(message: Message, extents: Extents) -> CodecText:
    """Plan the codec of a message or of a part of a service or action."""

    def reference(type_: NamespacedType) -> str:
        return class_reference(type_, message)

    groups = steps_of(message, extents)
    is_large = extents.of(message).is_large
    constants = Constants(message.name)
    type_ = NamespacedType(message.package, message.folder, message.name)
    serialize = Encoder(constants, reference).plan(message.name, groups, is_large=is_large)
    deserialize = Decoder(constants, reference).plan(message.name, type_, groups, is_large=is_large)
    nested = "".join(f", {reference(nested_type)}" for nested_type in _field_classes(message))
    own = f"{message.name}, _serialize_{message.name}, _deserialize_{message.name}"
    attachments = [f"{constants.runtime('attach_codec')}({own}{nested})"]
    if is_large:
        parts = f"{message.name}, _write_{message.name}, _read_{message.name}"
        attachments.append(f"{constants.runtime('attach_parts')}({parts})")
    attachment = "\n".join(line for statement in attachments for line in wrapped(statement, 0))
    return CodecText(
        runtime_imports=constants.imported,
        class_types=tuple(dict.fromkeys(_classes(step for steps in groups for step in steps))),
        constants=constants.lines,
        serialize=serialize,
        deserialize=deserialize,
        attachment=attachment,
    )


def _field_classes(message: Message) -> list[NamespacedType]:
    """The classes of the fields that hold messages, in the order of the fields."""
    result: list[NamespacedType] = []
    for field in message.fields:
        match field.type:
            case NamespacedType() as type_:
                result.append(type_)
            case (
                Array(NamespacedType() as type_, _)
                | BoundedSequence(NamespacedType() as type_, _)
                | UnboundedSequence(NamespacedType() as type_)
            ):
                result.append(type_)
            case _:
                pass
    return result


def _classes(steps: Iterable[Step]) -> Iterator[NamespacedType]:
    for step in steps:
        if isinstance(step, Nested | Messages):
            yield step.type
        if isinstance(step, Messages):
            yield from _classes(step.steps)
