"""Deserialise any message by what is known about its fields: slower than generated functions, never wrong.

A generated function comes here if the bytes are not what a correct little-endian peer sends. It tolerates
what compiled type supports tolerate: the other byte order, a string of length 0 or without its NUL,
characters after a NUL (dropped), bytes that are not UTF-8 (U+FFFD), any non-zero boolean, trailing bytes. It
is stricter in two ways: it refuses a sequence or a string over its bound, because nobody may send one, and a
header that announces another encoding than plain CDR, because its bytes would be misread. A wstring keeps a
leading U+FEFF.
"""

from __future__ import annotations

from array import array
from struct import unpack_from
from sys import byteorder
from typing import Any

from ifgen_runtime.codec import creator
from ifgen_runtime.errors import DeserializationError, Problem
from ifgen_runtime.field_types import Basic, Field, Text, fields_of, smallest_element
from ifgen_runtime.lazy import numpy

_HEADER_SIZE = 4
_BYTE_ORDERS = {b"\0\0": ">", b"\0\1": "<"}


def decode_any(data: bytes, cls: type[Any], *, bounded: bool = True, views: bool = False) -> Any:
    """The message of class `cls` in these bytes; DeserializationError if they are not one.

    Without `bounded`, sequences and strings may be over their bound, which compiled type supports accept.
    With `views`, sequences of numbers stay in these bytes, as `views.SequenceView`, in their byte order.
    TypeError if `cls` is not a message class.
    """
    fields_of(cls)
    try:
        order = _BYTE_ORDERS.get(data[:2])
        if len(data) < _HEADER_SIZE:
            raise Problem(f"expected a header of 4 bytes, got {len(data)} bytes")
        if order is None:
            raise Problem(f"expected plain CDR (header 0000 or 0001), got header {data[:2].hex()}")
        return Reader(data, order, bounded=bounded, views=views).message(cls)
    except Problem as problem:
        raise DeserializationError(cls.__name__ + problem.place, problem.text) from None


def size_of(data: bytes, cls: type[Any]) -> int:
    """The number of bytes that a message takes of those it was read from, its header included."""
    reader = Reader(data, _BYTE_ORDERS[data[:2]], bounded=False)
    reader.message(cls)
    return reader.position


class Reader:
    """Reads values at a position that only grows; `order` is `<` or `>`. Raises Problem."""

    def __init__(
        self,
        data: bytes,
        order: str,
        position: int = _HEADER_SIZE,
        *,
        bounded: bool = True,
        views: bool = False,
    ) -> None:
        self._data = data
        self._order = order
        self._swapped = (order == ">") != (byteorder == "big")
        self.position = position
        self._bounded = bounded
        self._views = views

    def message(self, cls: type[Any]) -> Any:
        """A message: its fields, or the one byte of a message without fields."""
        message = creator(cls)()
        self.fill(message)
        return message

    def fill(self, message: Any) -> None:
        """Read the fields of a message that has none yet."""
        cls = message.__class__
        fields = fields_of(cls)
        if not fields:
            self._take(1)
        for field in fields:
            try:
                value = self._collection(field) if field.is_collection else self._value(field.type)
            except Problem as problem:
                raise problem.at(f".{field.name}") from None
            setattr(message, field.slot, value)

    def _take(self, size: int, alignment: int = 1) -> int:
        """Move on over `size` bytes; their position."""
        start = self.position + (_HEADER_SIZE - self.position) % alignment
        if size > len(self._data) - start:
            left = max(len(self._data) - start, 0)
            raise Problem(f"truncated: {size} bytes needed at byte {start}, {left} left")
        self.position = start + size
        return start

    def _value(self, type_: Basic | Text | type[Any]) -> Any:
        if isinstance(type_, Basic):
            start = self._take(type_.size, type_.size)
            value = unpack_from(self._order + type_.format, self._data, start)[0]
            return value.decode("latin-1") if type_.name == "char" else value
        if isinstance(type_, Text):
            return self.wide_text(type_.maximum) if type_.wide else self._text(type_.maximum)
        return self.message(type_)

    def _unsigned(self) -> int:
        value: int = unpack_from(self._order + "I", self._data, self._take(4, 4))[0]
        return value

    def _text(self, maximum: int | None) -> str:
        size = self._unsigned()
        start = self._take(size)
        text = self._data[start : start + size].partition(b"\0")[0].decode(errors="replace")
        self._check_bound(len(text), maximum, "characters")
        return text

    def wide_text(self, maximum: int | None) -> str:
        """A wstring with at most the given number of characters."""
        count = self._unsigned()
        start = self._take(4 * count)
        units = unpack_from(f"{self._order}{count}I", self._data, start)
        if any(unit > 0xFFFF for unit in units):
            raise Problem(f"{hex(max(units))} is not a UTF-16 code unit")
        try:
            text = b"".join(unit.to_bytes(2, "little") for unit in units).decode("utf-16-le")
        except UnicodeDecodeError as failure:
            raise Problem(f"half of a surrogate pair at code unit {failure.start // 2}") from None
        self._check_bound(len(text), maximum, "characters")
        return text

    def _check_bound(self, count: int, maximum: int | None, what: str) -> None:
        if self._bounded and maximum is not None and count > maximum:
            raise Problem(f"expected at most {maximum} {what}, got {count}")

    def _collection(self, field: Field) -> Any:
        count = field.size
        if count is None:
            count = self._unsigned()
            self._check_bound(count, field.maximum, "elements")
        left = len(self._data) - self.position
        if count * smallest_element(field) > left:
            raise Problem(f"truncated: {count} elements cannot be in the {left} bytes left")
        if isinstance(field.type, Basic) and field.type.typecode:
            return self._numbers(count, field.type, fixed=field.size is not None)
        result: list[Any] = []
        for index in range(count):
            try:
                result.append(self._value(field.type))
            except Problem as problem:
                raise problem.at(f"[{index}]") from None
        return result

    def _numbers(self, count: int, type_: Basic, *, fixed: bool) -> Any:
        size = count * type_.size
        start = self._take(size, type_.size if count else 1)
        if fixed:
            data = bytearray(self._data[start : start + size])
            values = numpy.frombuffer(data, numpy.dtype(type_.dtype))
            return values.byteswap(inplace=True) if self._swapped else values
        if self._views:
            from ifgen_runtime.views import SequenceView  # with numpy

            dtype = numpy.dtype(type_.dtype).newbyteorder(">" if self._order == ">" else "<")
            return SequenceView(count, dtype, memoryview(self._data)[start : start + size])
        elements: array[Any] = array(type_.typecode)
        elements.frombytes(memoryview(self._data)[start : start + size])
        if self._swapped:
            elements.byteswap()
        return elements
