"""Serialise any message by what is known about its fields: slower than the generated functions, never wrong.

A generated function comes here when it met something that it does not know: it may still be a value that the
wire can hold (a list in place of an array.array, a numpy.float64, an object of rosidl's compiled class of the
same name), or it is refused, and then the path of the field is known.
"""

from __future__ import annotations

from array import array
from collections import UserString
from collections.abc import Iterable, Sequence, Set
from struct import Struct, pack
from sys import byteorder
from typing import Any

from ifgen_runtime.arrays import array_of, is_array
from ifgen_runtime.codec.texts import wstring_wire
from ifgen_runtime.errors import Problem, SerializationError, TextEncodingError
from ifgen_runtime.field_types import Basic, Field, Text, fields_of
from ifgen_runtime.lazy import numpy

_HEADER_SIZE = 4
_PACKERS = {character: Struct(f"<{character}").pack for character in "?cbBhHiIqQfd"}


def encode_any(message: Any) -> bytes:
    """The CDR form of a message; SerializationError if one of its fields cannot be sent."""
    cls = message.__class__  # of a message with checks, the public class
    out = bytearray(b"\0\1\0\0")
    try:
        fields_of(cls)
    except TypeError:
        raise SerializationError(cls.__name__, f"expected a message, got {kind_of(message)}") from None
    try:
        _message(out, message, cls)
    except Problem as problem:
        path, failure = cls.__name__ + problem.place, problem.failure
        if failure is not None:
            raise TextEncodingError(path, problem.text, *failure.args) from None
        raise SerializationError(path, problem.text) from None
    return bytes(out)


def encode_part(message: Any, position: int) -> bytes:
    """The CDR form of a message inside another one, at this position modulo 8. Raises Problem."""
    out = bytearray(_HEADER_SIZE + position)
    _message(out, message, message.__class__)
    return bytes(out[_HEADER_SIZE + position :])


def _message(out: bytearray, message: Any, cls: type[Any]) -> None:
    fields = fields_of(cls)
    if not fields:
        out.append(0)
    for field in fields:
        try:
            try:
                value = getattr(message, field.slot)
            except AttributeError:
                raise Problem("has no value") from None
            _field(out, value, field)
        except Problem as problem:
            raise problem.at(f".{field.name}") from None


def _field(out: bytearray, value: Any, field: Field) -> None:
    if not field.is_collection:
        _value(out, value, field.type)
    elif isinstance(field.type, Basic) and field.type.typecode:
        _numbers(out, value, field, field.type)
    else:
        values = listed(value, field.type)
        if not is_collection(values) or isinstance(values, bytes | bytearray):
            raise Problem(f"expected a list, got {kind_of(value)}")
        _count(out, len(values), field)
        _elements(out, values, field.type)


def is_collection(value: object) -> bool:
    """Whether it can stand for an array or a sequence: any sequence or set but a string, as in rosidl."""
    return isinstance(value, Sequence | Set) and not isinstance(value, str | UserString)


def listed(value: Any, type_: Basic | Text | type[Any]) -> Any:
    """The elements of an array or a buffer as a list, for a field of lists; anything else as it is."""
    if isinstance(type_, Basic) and type_.name == "octet":
        is_blob = isinstance(value, bytes | bytearray) or is_array(value)
        return [bytes([octet]) for octet in array_of("B", value)] if is_blob else value
    return numpy.asarray(value).ravel().tolist() if is_array(value) else value


def _is_array(value: object) -> bool:
    return isinstance(value, array)


def _count(out: bytearray, count: int, field: Field) -> None:
    if field.size is not None:
        if count != field.size:
            raise Problem(f"expected {field.size} elements, got {count}")
        return
    if field.maximum is not None and count > field.maximum:
        raise Problem(f"expected at most {field.maximum} elements, got {count}")
    _align(out, 4)
    out += pack("<I", count)


def _elements(out: bytearray, values: Iterable[Any], type_: Basic | Text | type[Any]) -> None:
    for index, value in enumerate(values):
        try:
            _value(out, value, type_)
        except Problem as problem:
            raise problem.at(f"[{index}]") from None


def _align(out: bytearray, alignment: int) -> None:
    out += bytes((_HEADER_SIZE - len(out)) % alignment)


def _value(out: bytearray, value: Any, type_: Basic | Text | type[Any]) -> None:
    if isinstance(type_, Basic):
        _align(out, type_.size)
        out += basic_wire(value, type_)
    elif isinstance(type_, Text):
        _align(out, 4)
        out += text_wire(value, type_)
    else:
        if not is_message(value, type_):
            raise Problem(f"expected {type_name(type_)}, got {kind_of(value)}")
        _message(out, value, type_)


def is_message(value: Any, cls: type[Any]) -> bool:
    """Whether it is of the class, or of another class for the same type name: rosidl's compiled one."""
    if isinstance(value, cls):
        return True
    names = {(base.__name__, base.__module__.partition(".")[0]) for base in type(value).__mro__}
    return (cls.__name__, cls.__module__.partition(".")[0]) in names


def basic_wire(value: Any, type_: Basic) -> bytes:
    """The bytes of a basic value; Problem if the type cannot have it. What has an `__index__` is an int."""
    if type_.is_float:
        if not isinstance(value, float):
            raise Problem(f"expected float, got {kind_of(value)}")
    elif type_.name == "boolean":
        if not isinstance(value, bool):
            raise Problem(f"expected bool, got {kind_of(value)}")
    elif type_.name == "octet":
        if not isinstance(value, bytes | bytearray):
            raise Problem(f"expected bytes of length 1, got {kind_of(value)}")
        if len(value) != 1:
            raise Problem(f"expected bytes of length 1, got length {len(value)}")
        return bytes(value)
    elif type_.name == "char":
        return _character_wire(value)
    elif not hasattr(value, "__index__"):
        raise Problem(f"expected int, got {kind_of(value)}")
    try:
        return _PACKERS[type_.format](value)
    except Exception:
        if type_.is_float:
            raise Problem(f"{value!r} does not fit into a float32") from None
        raise Problem("expected an integer in [{}, {}], got {}".format(*type_.range, shown(value))) from None


def _character_wire(value: Any) -> bytes:
    if not isinstance(value, str | UserString):
        raise Problem(f"expected str of length 1, got {kind_of(value)}")
    if len(value) != 1:
        raise Problem(f"expected str of length 1, got length {len(value)}")
    try:
        return str(value).encode("latin-1")
    except UnicodeEncodeError:
        raise Problem(f"{str(value)!r} is above U+00FF: a char is one byte") from None


def shown(value: Any) -> str:
    """The value itself, if that can be read, or the beginning of it."""
    try:
        text = repr(value)
    except Exception:
        return kind_of(value)
    return text if len(text) <= 40 else f"{text[:40]}..."


def text_wire(value: Any, type_: Text) -> bytes:
    """The bytes of a string; Problem if the type cannot have it."""
    text = str(value) if isinstance(value, UserString) else value
    if not isinstance(text, str):
        raise Problem(f"expected str, got {kind_of(value)}")
    if type_.maximum is not None and len(text) > type_.maximum:
        raise Problem(f"expected at most {type_.maximum} characters, got {len(text)}")
    try:
        if type_.wide:
            return wstring_wire(str(text))
        encoded = text.encode()
    except UnicodeEncodeError as failure:
        said = f"half of a surrogate pair at character {failure.start} cannot be sent"
        raise Problem(said, failure) from None
    if 0 in encoded:
        raise Problem(f"NUL at character {text.index(chr(0))}: a string ends there on the wire")
    return pack("<I", len(encoded) + 1) + encoded + b"\0"


def _numbers(out: bytearray, value: Any, field: Field, type_: Basic) -> None:
    if _is_array(value):
        if value.typecode != type_.typecode:
            raise Problem(f"expected array.array({type_.typecode!r}), got array.array({value.typecode!r})")
        count, data = len(value), _little_endian(value)
    elif hasattr(value, "dtype") and hasattr(value, "tobytes"):
        wanted = numpy.dtype(type_.dtype)
        if value.dtype.newbyteorder("=") != wanted:
            raise Problem(f"expected dtype {wanted}, got {value.dtype.str}")
        count, data = int(value.size), value.astype(wanted.newbyteorder("<")).tobytes()
    elif is_collection(value):
        count, data = len(value), _packed(value, type_)
    else:
        expected = "numpy.ndarray" if field.size is not None else f"array.array({type_.typecode!r})"
        raise Problem(f"expected {expected}, got {kind_of(value)}")
    _count(out, count, field)
    if count:
        _align(out, type_.size)
    out += data


def _little_endian(values: array[Any]) -> bytes:
    if byteorder == "big":
        values = values[:]
        values.byteswap()
    return values.tobytes()


def _packed(values: Iterable[Any], type_: Basic) -> bytes:
    packed: list[bytes] = []
    for index, value in enumerate(values):
        try:
            packed.append(basic_wire(value, type_))
        except Problem as problem:
            raise problem.at(f"[{index}]") from None
    return b"".join(packed)


def kind_of(value: object) -> str:
    """The kind of a value, for an error message."""
    return "None" if value is None else type_name(type(value))


def type_name(cls: type[Any]) -> str:
    """The name of a class: `std_msgs/msg/String` for a message class, `numpy.float64`, `int`."""
    package, *folders = cls.__module__.split(".")
    if folders and folders[0] in {"msg", "srv", "action"} and hasattr(cls, "_fields_and_field_types"):
        return f"{package}/{folders[0]}/{cls.__name__}"
    return cls.__name__ if package == "builtins" else f"{package}.{cls.__name__}"
