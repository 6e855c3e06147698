"""Checks of fields: the rules of rosidl, and the texts of its AssertionErrors."""

from __future__ import annotations

from array import array
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set, Sized
from math import inf
from typing import Any, TypeAlias, TypeGuard

from ifgen_runtime.arrays import array_of, ndarray_of
from ifgen_runtime.field_types import Basic, Field, Text
from ifgen_runtime.lazy import numpy

Setter: TypeAlias = Callable[[Any, Any], None]
"""Stores a value in a message; raises AssertionError if the field cannot have it."""
Check: TypeAlias = Callable[[Any], Any]
"""Gives the value back; raises AssertionError if the field cannot have it."""

_FLOAT_LIMITS = {"float": 3.402823466e38, "double": 1.7976931348623157e308}


def setter(field: Field, store: Setter) -> Setter:
    """The setter of a field; `store` sets its slot."""
    start = f"The '{field.slot[1:]}'"
    if field.is_collection:
        return _collection_setter(field, store, start)
    match field.type:
        case Text(maximum=int(bound)):
            text = f"{start} field must be string value not longer than {bound}"
            return _sized_setter(store, (str, UserString), range(bound + 1), text)
        case Basic(name="octet"):
            text = f"{start} field must be of type 'bytes' or 'ByteString' with length 1"
            return _sized_setter(store, (bytes, bytearray), range(1, 2), text)
        case Basic(name="char"):
            return _character_setter(store, start)
        case Basic(typecode=str(typecode)) if typecode:
            return _number_setter(field.type, store, start)
        case Text() | Basic():
            return _type_setter(store, element_type(field), start)
        case message_class:
            return _message_setter(store, message_class, start)


def element_type(field: Field) -> type:
    """The class of the value, or of each element."""
    match field.type:
        case Text():
            return str
        case Basic(name="boolean"):
            return bool
        case Basic(name="octet"):
            return bytes
        case Basic(name="char"):
            return str
        case Basic():
            return float if field.type.is_float else int
        case message_class:
            return message_class


def _sized_setter(store: Setter, types: tuple[type[Sized], ...], sizes: range, text: str) -> Setter:
    def assign(message: Any, value: Any) -> None:
        if not isinstance(value, types) or len(value) not in sizes:
            raise AssertionError(text)
        store(message, value)

    return assign


def _character_setter(store: Setter, start: str) -> Setter:
    text = (
        f"{start} field must be of type 'str' or 'UserString' "
        "with length 1 and the character ord() in [-128, 127]"
    )

    def assign(message: Any, value: Any) -> None:
        if not isinstance(value, (str, UserString)) or len(value) != 1 or not str(value).isascii():
            raise AssertionError(text)
        store(message, value)

    return assign


def _type_setter(store: Setter, expected: type, start: str) -> Setter:
    text = f"{start} field must be of type '{expected.__name__}'"

    def assign(message: Any, value: Any) -> None:
        if not isinstance(value, expected):
            raise AssertionError(text)
        store(message, value)

    return assign


def _number_setter(basic: Basic, store: Setter, start: str) -> Setter:
    expected = float if basic.is_float else int
    low, high = _limits(basic)
    type_text = f"{start} field must be of type '{expected.__name__}'"
    name = _number_name(basic)
    range_text = f"{start} field must be {'an' if name[0] in 'iu' else 'a'} {name} in [{low!r}, {high!r}]"

    def assign(message: Any, value: Any) -> None:
        if not isinstance(value, expected):
            raise AssertionError(type_text)
        if (value < low or value > high) and value not in (inf, -inf):
            raise AssertionError(range_text)
        store(message, value)

    return assign


def _message_setter(store: Setter, message_class: type, start: str) -> Setter:
    text = f"{start} field must be a sub message of type '{message_class.__name__}'"

    def assign(message: Any, value: Any) -> None:
        if not isinstance(value, message_class) and not _is_twin(value, message_class):
            raise AssertionError(text)
        store(message, value)

    return assign


def _is_twin(value: Any, message_class: type) -> bool:
    """Whether real ROS, or ifgen, brought the class of this value for the same type."""
    names = value.__class__.__name__, value.__class__.__module__
    return names == (message_class.__name__, message_class.__module__)


def _limits(basic: Basic) -> tuple[float, float]:
    if basic.is_float:
        limit = _FLOAT_LIMITS[basic.name]
        return -limit, limit
    return basic.range


def _number_name(basic: Basic) -> str:
    if basic.is_float:
        return basic.name
    return "integer" if basic.range[0] else "unsigned integer"


def _collection_setter(field: Field, store: Setter, start: str) -> Setter:
    is_valid, text = _list_check(field), f"{start} field must be {_list_text(field)}"

    def checked(value: Any) -> Any:
        if not is_valid(value):
            raise _refusal(text, value, field.type)
        return value

    if not isinstance(field.type, Basic) or not field.type.typecode:
        return lambda message, value: store(message, checked(value))
    if field.is_sequence:
        return _array_setter(field, field.type.typecode, checked, store, start)
    return _numpy_setter(field, field.type.dtype, checked, store, start)


def _refusal(text: str, value: Any, type_: Basic | Text | type[Any]) -> AssertionError:
    """The error of a check. rosidl's checks refuse numpy arrays for sequences, so a note says what passes."""
    error = AssertionError(text)
    if isinstance(type_, Basic) and type_.typecode and hasattr(value, "astype"):
        passes = f"array.array({type_.typecode!r}, value.astype({type_.dtype!r}).tobytes())"
        error.add_note(f"as in rosidl, no numpy array passes this check; {passes} does")
    return error


def _list_text(field: Field) -> str:
    text = "a set or sequence"
    if field.size is not None:
        text += f" with length {field.size}"
    if field.maximum is not None:
        text += f" with length <= {field.maximum}"
    if isinstance(field.type, Text) and field.type.maximum is not None:
        text += f" and each string value not longer than {field.type.maximum}"
    text += f" and each value of type '{element_type(field).__name__}'"
    if isinstance(field.type, Basic) and field.type.typecode:
        low, high = _limits(field.type)
        limits = f"{low:f}, {high:f}" if field.type.is_float else f"{low}, {high}"
        text += f" and each {_number_name(field.type)} in [{limits}]"
    elif _is_char(field):
        text += " and each char in [0, 255]"
    return text


def _is_char(field: Field) -> bool:
    return isinstance(field.type, Basic) and field.type.name == "char"


def _list_check(field: Field) -> Callable[[Any], bool]:
    size, maximum, expected = field.size, field.maximum, element_type(field)
    bound = field.type.maximum if isinstance(field.type, Text) else None
    numeric = isinstance(field.type, Basic) and field.type.typecode
    low, high = _limits(field.type) if isinstance(field.type, Basic) and numeric else (0, 0)
    is_char = _is_char(field)
    # All bytes are valid for uint8: asking each would take 0.1 s for an image.
    valid_bytes = (bytes, bytearray) if isinstance(field.type, Basic) and field.type.typecode == "B" else ()

    def is_valid(value: Any) -> bool:
        return (
            _is_list(value)
            and (bound is None or all(len(element) <= bound for element in value))
            and (size is None or len(value) == size)
            and (maximum is None or len(value) <= maximum)
            and (isinstance(value, valid_bytes) or has_valid_elements(value))
        )

    def has_valid_elements(value: Sequence[Any]) -> bool:
        return (
            all(isinstance(element, expected) or _is_twin(element, expected) for element in value)
            and (not numeric or all(not (e < low or e > high) or e in (inf, -inf) for e in value))
            and (not is_char or all(ord(element) < 256 for element in value))  # TypeError, as rosidl's
        )

    return is_valid


def _is_list(value: object) -> TypeGuard[Sequence[Any]]:
    return isinstance(value, (Sequence, Set, UserList)) and not isinstance(value, (str, UserString))


def _is_a(value: Any, cls: type) -> bool:
    # isinstance() would make type checkers think of an array of unknown elements.
    return isinstance(value, cls)


def _array_setter(field: Field, typecode: str, checked: Check, store: Setter, start: str) -> Setter:
    def assign(message: Any, value: Any) -> None:
        if not _is_a(value, array):
            store(message, array_of(typecode, checked(value)))
            return
        if value.typecode != typecode:
            raise AssertionError(f"{start} array.array() must have the type code of '{typecode}'")
        if field.maximum is not None and len(value) > field.maximum:
            raise AssertionError(f"{start} array.array() must have a size <= {field.maximum}")
        store(message, value)

    return assign


def _numpy_setter(field: Field, dtype: str, checked: Check, store: Setter, start: str) -> Setter:
    scalar_type = numpy.dtype(dtype).type

    def assign(message: Any, value: Any) -> None:
        if not _is_a(value, numpy.ndarray):
            store(message, ndarray_of(scalar_type, checked(value)))
            return
        if value.dtype != dtype:
            raise AssertionError(f"{start} numpy.ndarray() must have the dtype of 'numpy.{dtype}'")
        if value.size != field.size:
            raise AssertionError(f"{start} numpy.ndarray() must have a size of {field.size}")
        store(message, value)

    return assign
