"""From a message to the text of its codec."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.generator_py.codec.decode import Decoder
from ifgen.generator_py.codec.encode import Encoder
from ifgen.generator_py.codec.layout import Messages, Nested, Step, steps_of
from ifgen.generator_py.codec.text import Constants, wrapped
from ifgen.generator_py.names import class_reference

_MOST_LOOPS = 18
"""Python takes 20 nested blocks, of which the codec needs one around its loops."""

_RUNTIME_NAME = re.compile(r"(?<![\w.\"])[a-z_]+(?![\w\"])")
_RUNTIME_NAMES = frozenset(
    {
        "any_longer",
        "around_text",
        "array",
        "attach_codec",
        "booleans_wire",
        "creator",
        "decode_any",
        "each_unpacker",
        "encode_any",
        "four_zeros",
        "numeric",
        "octets_wire",
        "packer",
        "padded_strings_wire",
        "padded_wire",
        "repeat",
        "strings",
        "strings_wire",
        "unpack_from",
        "unpacker",
        "wire",
        "wstring",
        "wstring_wire",
        "wstrings",
        "wstrings_wire",
    }
)


@dataclass(frozen=True, slots=True)
class CodecText:
    """The codec of one class, to be placed behind the classes of its module.

    Import `runtime_imports` from `ifgen_runtime.codec`, and the classes of `class_types` that are of other
    modules under the names that `class_reference` gives them. Then come the `constants` (assignments at
    module level), the functions `serialize` and `deserialize` (whole text without annotations, named
    `_serialize_<ClassName>` and `_deserialize_<ClassName>`), and last the statement `attachment`, which hangs
    them on the class.
    """

    runtime_imports: tuple[str, ...]
    class_types: tuple[NamespacedType, ...]
    constants: tuple[str, ...]
    serialize: str
    deserialize: str
    attachment: str


def plan_codec(message: Message, registry: Registry) -> CodecText:
    """Plan the codec of a message or of a part of a service or action."""

    def reference(type_: NamespacedType) -> str:
        return class_reference(type_, message)

    steps = steps_of(message, registry)
    constants = Constants(message.name)
    type_ = NamespacedType(message.package, message.folder, message.name)
    if _loops(steps) > _MOST_LOOPS:
        serialize = f"def _serialize_{message.name}(m):\n    return encode_any(m)"
        deserialize = f"def _deserialize_{message.name}(data):\n    return decode_any(data, {message.name})"
        classes = _field_classes(message)
    else:
        serialize = Encoder(constants, reference).plan(message.name, steps)
        deserialize = Decoder(constants, reference).plan(message.name, type_, steps)
        classes = _classes(steps)
    nested = ", ".join(reference(nested_type) for nested_type in _field_classes(message))
    attachment = "\n".join(
        wrapped(
            f"attach_codec({message.name}, _serialize_{message.name}, _deserialize_{message.name}"
            f"{', ' if nested else ''}{nested})",
            0,
        )
    )
    text = "\n".join([*constants.lines, serialize, deserialize, attachment])
    return CodecText(
        runtime_imports=tuple(sorted(_RUNTIME_NAMES.intersection(_RUNTIME_NAME.findall(text)))),
        class_types=tuple(dict.fromkeys(classes)),
        constants=constants.lines,
        serialize=serialize,
        deserialize=deserialize,
        attachment=attachment,
    )


def _loops(steps: tuple[Step, ...]) -> int:
    """How deep arrays and sequences of messages are nested."""
    return max((1 + _loops(step.steps) for step in steps if isinstance(step, Messages)), default=0)


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


def _classes(steps: tuple[Step, ...]) -> list[NamespacedType]:
    result: list[NamespacedType] = []
    for step in steps:
        if isinstance(step, Nested | Messages):
            result.append(step.type)
        if isinstance(step, Messages):
            result.extend(_classes(step.steps))
    return result
