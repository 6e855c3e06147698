"""The size of the part of a message that one function handles. Larger messages get several functions.

Messages are inlined where they are nested, which multiplies their text with each level of nesting, and Python
compiles a function of many thousand lines in a time that grows faster than they do. Both end here: no
function handles much more than `MOST_STEPS`, so the text of a message grows as its fields do.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

from ifgen.definition.interfaces import Field, Message, Registry
from ifgen.definition.references import references
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)
from ifgen.generator_py.codec.program import NUMBERS

MOST_STEPS: Final = 128

MOST_LOOPS: Final = 17
"""Python takes 20 nested blocks: the codec needs one around its loops, and a sequence of messages is one."""


@dataclass(frozen=True, slots=True)
class Extent:
    """The number of steps of a message, nested messages included.

    `steps` are the fields that its text handles one by one, and the placeholders of empty messages; `loops`
    says how deep arrays and sequences of messages are nested. `has_sequences` is true if it or a message that
    it nests has a sequence of numbers.
    """

    steps: int
    loops: int
    has_sequences: bool = False

    @property
    def is_large(self) -> bool:
        """True if the message has its own functions, which are called where it is nested."""
        return self.steps > MOST_STEPS or self.loops > MOST_LOOPS


_ONE_STEP = Extent(1, 0)


class Extents:
    """The extents of the messages in a registry, each worked out once."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self._known: dict[str, Extent] = {}

    def of(self, message: Message) -> Extent:
        """The extent of a message."""
        known = self._known.get(message.type_name)
        if known is not None:
            return known
        pending = [message]  # a stack of our own, since chains of messages may be long
        while pending:
            names = {type_.type_name for _, type_ in references(pending[-1])}
            held = [name for name in names if name not in self._known]
            if held:
                pending += map(self.registry.message, held)
            else:
                current = pending.pop()
                self._known[current.type_name] = self._sum(current)
        return self._known[message.type_name]

    def groups(self, message: Message) -> Iterator[tuple[Field, ...]]:
        """The fields of a message in order, in groups that one function handles."""
        self.of(message)
        group: list[Field] = []
        steps = 0
        for field in message.fields:
            more = self._of_field(field.type).steps
            if group and steps + more > MOST_STEPS:
                yield tuple(group)
                group, steps = [], 0
            group.append(field)
            steps += more
        yield tuple(group)

    def _sum(self, message: Message) -> Extent:
        extents = [self._of_field(field.type) for field in message.fields] or [_ONE_STEP]
        return Extent(
            sum(extent.steps for extent in extents),
            max(extent.loops for extent in extents),
            any(extent.has_sequences for extent in extents),
        )

    def _of_field(self, type_: FieldType) -> Extent:
        match type_:
            case NamespacedType():
                nested = self._nested(type_)
                return Extent(1 + nested.steps, nested.loops, nested.has_sequences)
            case (
                Array(NamespacedType() as element, _)
                | BoundedSequence(NamespacedType() as element, _)
                | UnboundedSequence(NamespacedType() as element)
            ):
                nested = self._nested(element)
                return Extent(1 + nested.steps, 1 + nested.loops, nested.has_sequences)
            case BoundedSequence(BasicType(name), _) | UnboundedSequence(BasicType(name)):
                return Extent(1, 0, bool(NUMBERS[name].typecode))
            case _:
                return _ONE_STEP

    def _nested(self, type_: NamespacedType) -> Extent:
        extent = self._known[type_.type_name]
        return replace(_ONE_STEP, has_sequences=extent.has_sequences) if extent.is_large else extent
