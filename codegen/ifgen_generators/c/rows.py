"""The table of a message: what its codec does with each field, in wire order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from ifgen.model import Field, Message, safe_name

from ifgen_generators.c.bounds import MAX_CHARACTERS, Bounds

_COUNT_SIZE: Final = 4
_HEADER_SIZE: Final = 4


@dataclass(frozen=True, slots=True)
class Row:
    """One row: the members of `ifgen_cdr_row`, whose offset is that of `member` in the struct `owner`.

    `label` is the path for failures. A row of numbers ends with `last`, and has `stride` bytes.
    """

    kind: str
    owner: str = ""
    member: str = ""
    label: str = ""
    count: int = 0
    stride: str = "0"
    width: int = 0
    extra: int = 0
    last: str = ""


@dataclass(frozen=True, slots=True)
class Numbers:
    """Memory that has numbers of `width` bytes only, `size` bytes in all; all of them are floats, or none."""

    width: int
    is_float: bool
    size: int


class Tables:
    """The rows of messages, and the most bytes that these take on the wire."""

    def __init__(self, types: Sequence[Message], bounds: Bounds) -> None:
        self._types = {message.type_name: message for message in types}
        self._bounds = bounds
        self._numbers: dict[str, Numbers | None] = {}
        self._depths: dict[str, int] = {}
        for message in types:
            self._numbers[message.type_name] = self._only_numbers(message)
            self._depths[message.type_name] = self._depth(message)

    @property
    def depth(self) -> int:
        """How deep repeated messages are nested in any message, at least 1."""
        return max(1, *self._depths.values()) if self._depths else 1

    def rows(self, message: Message) -> tuple[Row, ...]:
        """The rows of a message, with the end."""
        return (*_merged(self._rows(message, c_name(message), "", "")), Row("END"))

    def max_size(self, message: Message) -> int:
        """The most bytes of a payload, header included."""
        return _HEADER_SIZE + self._end(message, _Position(0, 8, 0)).size

    def numbers(self, field: Field) -> Numbers | None:
        """The numbers of an element of a field, if it has nothing else."""
        if field.type.message:
            return self._numbers[field.type.message.type_name]
        if field.type.bits is None or field.type.primitive == "bool":
            return None
        width = field.type.bits // 8
        return Numbers(width, field.type.primitive.startswith("float"), width)

    def nested(self, field: Field) -> Message:
        """The message that a field holds."""
        assert field.type.message is not None, "only asked for messages"
        return self._types[field.type.message.type_name]

    def _only_numbers(self, message: Message) -> Numbers | None:
        size, kinds = 0, set[tuple[int, bool]]()
        for field in message.fields:
            numbers = self.numbers(field)
            if numbers is None or (field.type.many and field.type.size is None):
                return None
            size += numbers.size * (field.type.size or 1)
            kinds.add((numbers.width, numbers.is_float))
        return Numbers(*kinds.pop(), size) if len(kinds) == 1 else None

    def _depth(self, message: Message) -> int:
        return max(
            (
                self._depths[field.type.message.type_name] + (field.type.many and self.numbers(field) is None)
                for field in message.fields
                if field.type.message
            ),
            default=0,
        )

    def _rows(self, message: Message, owner: str, member: str, label: str) -> Iterator[Row]:
        if message.placeholder:
            yield Row("BLANK", label=label.rstrip("."))
        for field in message.fields:
            yield from self._field(field, owner, member + field.names["c"], label + field.name)

    def _field(self, field: Field, owner: str, member: str, label: str) -> Iterator[Row]:
        room, type_ = self._bounds.of(field), field.type
        count = 1
        data = member
        if type_.many:
            count = type_.size or 0
            if type_.size is None:
                yield Row("COUNT", owner, f"{member}.size", label, room.elements or 0)
                data = f"{member}.data"
        element = f"{data}[0]" if type_.many else data
        stride = f"sizeof(((const {owner} *)0)->{element})"
        numbers = self.numbers(field)
        if numbers is not None:
            whole, last = str(numbers.size * max(count, 1)), data if count else ""
            floats = int(numbers.is_float)
            yield Row("NUMBERS", owner, data, label, min(count, 1), whole, numbers.width, floats, last)
        elif type_.message and not type_.many:
            yield from self._rows(self.nested(field), owner, f"{member}.", f"{label}.")
        elif type_.message:
            nested = self.nested(field)
            body = (*_merged(self._rows(nested, c_name(nested), "", f"{label}[].")), Row("END"))
            yield Row("REPEAT", owner, data, label, count, stride, extra=len(body))
            yield from body
        elif type_.primitive == "bool":
            yield Row("BOOLS", owner, data, label, count, stride)
        else:
            bound = type_.string_bound or 0
            extra = bound if bound <= MAX_CHARACTERS else 0
            kind = "STRINGS" if type_.primitive == "string" else "WSTRINGS"
            yield Row(kind, owner, data, f"{label}[]" if type_.many else label, count, stride, extra=extra)

    def _end(self, message: Message, position: _Position) -> _Position:
        if message.placeholder:
            return position.after(1, 1)
        for field in message.fields:
            position = self._field_end(field, position)
        return position

    def _field_end(self, field: Field, position: _Position) -> _Position:
        room, numbers = self._bounds.of(field), self.numbers(field)
        count = (room.elements or 0) if field.type.many else 1
        if field.type.many and field.type.size is None:
            position = position.after(_COUNT_SIZE, _COUNT_SIZE)
        if numbers is not None:
            end = position.after(numbers.width, numbers.size * count) if count else position
        elif field.type.primitive == "bool":
            end = position.after(1, count)
        else:
            end = self._element_end(field, position)
            if count > 1:  # the others start anywhere
                each = self._element_end(field, _Position(0, 1, 0))
                end = _Position(end.size + each.size * (count - 1), 1, 0)
        # A sequence may be empty.
        return end if field.type.size is not None or not field.type.many else end.lost()

    def _element_end(self, field: Field, start: _Position) -> _Position:
        if field.type.message:
            return self._end(self.nested(field), start)
        text = self._bounds.of(field).text or 0
        size = text + 1 if field.type.primitive == "string" else 4 * text
        return start.after(_COUNT_SIZE, _COUNT_SIZE + size).lost()


@dataclass(frozen=True, slots=True)
class _Position:
    """The most bytes before it. The position is `remainder` modulo `modulus`."""

    size: int
    modulus: int
    remainder: int

    def after(self, alignment: int, size: int) -> _Position:
        if self.modulus >= alignment:
            padding = -self.remainder % alignment
            start = replace(
                self, size=self.size + padding, remainder=(self.remainder + padding) % self.modulus
            )
        else:
            start = _Position(self.size + alignment - 1, alignment, 0)
        return replace(start, size=start.size + size, remainder=(start.remainder + size) % start.modulus)

    def lost(self) -> _Position:
        return _Position(self.size, 1, 0)


def c_name(message: Message) -> str:
    """The name of a message's struct."""
    return safe_name(f"{message.package}__{message.folder}__{message.name}", "c")


def _merged(rows: Iterable[Row]) -> Iterator[Row]:
    """One row for numbers of one width, floats or not, that stand beside each other in one struct.

    Those of a nested struct that has others too are left apart: it may end with padding.
    """
    before: Row | None = None
    for row in rows:
        if before and before.last and row.last and _can_join(before, row):
            before = replace(before, stride=str(int(before.stride) + int(row.stride)), last=row.last)
            continue
        if before:
            yield before
        before = row
    if before:
        yield before


def _can_join(first: Row, second: Row) -> bool:
    same_struct = first.last.rpartition(".")[0] == second.member.rpartition(".")[0]
    kinds = ((row.owner, row.width, row.extra) for row in (first, second))
    return same_struct and len(set(kinds)) == 1
