"""Fields of recorded messages as numpy arrays."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from ifgen_runtime.bag.errors import BagError
from ifgen_runtime.field_types import Basic, Field, Text, fields_of, type_name

_PATH: Final = re.compile(r"[a-zA-Z]\w*(\[\d+\])*(\.[a-zA-Z]\w*(\[\d+\])*)*")
_STEP: Final = re.compile(r"(?P<name>\w+)|\[(?P<index>\d+)\]")
_BATCH: Final = 4096
_TIMES: Final = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")

Array = NDArray[Any]


class Column:
    """One field of a message class, or a part of one: `pose.position.x`, `position`, `points[0].x`."""

    def __init__(self, cls: type[Any], path: str) -> None:
        if not _PATH.fullmatch(path):
            raise BagError(f"{path!r} is no path of a field, such as pose.position.x or position[0]")
        self.path = path
        self._gets, field, indexed = _steps(cls, path)
        self._is_many = field.is_collection and not indexed
        self._size = field.size if self._is_many else None
        self._is_time = not self._is_many and isinstance(field.type, type) and type_name(field.type) in _TIMES
        if isinstance(field.type, type) and not self._is_time:
            raise BagError(_not_numbers(path, field, self._is_many))
        self.dtype = _dtype(field)

    def value(self, message: Any) -> Any:
        """The value of a message."""
        for get in self._gets:
            message = get(message)
        return message.sec * 10**9 + message.nanosec if self._is_time else message

    def array(self, messages: Iterable[Any], ragged: bool = False) -> Array:
        """The values of messages: of shape (n,), or (n, m) for arrays. Raises BagError where sizes differ."""
        builder = self.builder(ragged)
        for message in messages:
            builder.add(message)
        return builder.array()

    def builder(self, ragged: bool = False) -> Builder:
        """A builder that gathers the values, message by message."""
        return Builder(self, self._is_many, self._size, ragged)


class Builder:
    """Gathers the values of a column in blocks, so that memory is that of the array."""

    def __init__(self, column: Column, is_many: bool, size: int | None, ragged: bool) -> None:
        self._column, self._is_many, self._size, self._ragged = column, is_many, size, ragged and size is None
        self._blocks: list[Array] = []
        self._values: list[Any] = []
        self._count = 0

    def add(self, message: Any) -> None:
        """Add the value of a message."""
        try:
            value = self._column.value(message)
        except IndexError:
            text = f"{self._column.path} is beyond the end of the sequence in message {self._count}"
            raise BagError(text) from None
        if self._is_many:
            self._check(value)
        self._values.append(value)
        self._count += 1
        if len(self._values) >= _BATCH:
            self._flush()

    def _check(self, value: Any) -> None:
        if self._ragged:
            return
        if self._size is None:
            self._size = len(value)
        elif len(value) != self._size:
            raise BagError(
                f"{self._column.path} has {self._size} values in the first message and {len(value)} in "
                f"message {self._count}: ask for ragged=True, or for one of them, as {self._column.path}[0]"
            )

    def _flush(self) -> None:
        dtype, values = self._column.dtype, self._values
        if self._is_many and self._ragged:
            block = np.empty(len(values), object)
            for index, value in enumerate(values):
                block[index] = _numbers(value, dtype)
        elif self._is_many:
            block = np.empty((len(values), self._size or 0), dtype)
            for index, value in enumerate(values):
                block[index] = _numbers(value, dtype)
        else:
            plain = [value[0] for value in values] if values and isinstance(values[0], bytes) else values
            block = np.empty(len(values), dtype)
            block[:] = [ord(v) for v in plain] if dtype == np.uint8 and isinstance(plain[0], str) else plain
        self._blocks.append(block)
        self._values = []

    def array(self) -> Array:
        """All that was added."""
        if self._values:
            self._flush()
        if not self._blocks:
            return np.empty(
                (0, self._size or 0) if self._is_many and not self._ragged else 0, self._column.dtype
            )
        return self._blocks[0] if len(self._blocks) == 1 else np.concatenate(self._blocks)


def leaves(cls: type[Any], prefix: str = "") -> Iterator[str]:
    """The paths of all single values of a message: those that make good columns of a table."""
    for field in fields_of(cls):
        path = prefix + field.name
        if field.is_collection:
            continue
        if isinstance(field.type, type) and type_name(field.type) not in _TIMES:
            yield from leaves(field.type, f"{path}.")
        else:
            yield path


def _steps(cls: type[Any], path: str) -> tuple[list[Callable[[Any], Any]], Field, bool]:
    """The functions that lead to a value, its field, and whether one element of that is meant."""
    gets: list[Callable[[Any], Any]] = []
    field: Field | None = None
    indexed, so_far = False, ""
    for step in _STEP.finditer(path):
        if step["name"]:
            of: Any = cls if field is None else field.type
            if field is not None and field.is_collection and not indexed:
                raise BagError(f"{so_far} is a sequence: name one element, as {so_far}[0].{step['name']}")
            field, indexed = _field(of, step["name"], so_far), False
            gets.append(attrgetter(field.slot))
        else:
            if field is None or not field.is_collection or indexed:
                raise BagError(f"{so_far} is no sequence: {path} has no meaning")
            indexed = True
            gets.append(_element(field, int(step["index"]), so_far))
        so_far = path[: step.end()]
    assert field is not None  # the path has a name
    return gets, field, indexed


def _field(cls: Any, name: str, so_far: str) -> Field:
    fields = fields_of(cls) if isinstance(cls, type) else ()
    for field in fields:
        if field.name == name:
            return field
    whole = f"{type_name(cls)}" if isinstance(cls, type) else so_far
    has = f"it has {', '.join(field.name for field in fields)}" if fields else "it is a value without fields"
    raise BagError(f"{whole} has no field {name!r}: {has}")


def _element(field: Field, index: int, so_far: str) -> Callable[[Any], Any]:
    if field.size is not None and index >= field.size:
        raise BagError(f"{so_far} has {field.size} elements: {so_far}[{index}] is beyond its end")
    return lambda values: values[index]


def _dtype(field: Field) -> np.dtype[Any]:
    if isinstance(field.type, Basic):
        return np.dtype(field.type.dtype or {"boolean": "bool"}.get(field.type.name, "uint8"))
    return np.dtype(object) if isinstance(field.type, Text) else np.dtype(np.int64)


def _numbers(value: Any, dtype: np.dtype[Any]) -> Any:
    """A sequence as numpy takes it: octets and characters become numbers."""
    if dtype == np.uint8 and isinstance(value, list):
        items = cast("list[bytes | str]", value)
        each = (item if isinstance(item, bytes) else item.encode("latin-1") for item in items)
        return np.frombuffer(b"".join(each), dtype)
    return np.array(value, dtype)


def _not_numbers(path: str, field: Field, is_many: bool) -> str:
    inside = fields_of(field.type) if isinstance(field.type, type) else ()
    first = f"{path}{'[0]' if is_many else ''}.{inside[0].name}" if inside else path
    kind = "a sequence of messages" if is_many else "a message"
    return f"{path} is {kind}, not a number or a text: name a field of it, as {first}"
