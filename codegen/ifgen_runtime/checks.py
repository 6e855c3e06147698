"""Messages that check what they are given: `check_fields=True`, or ROS_PYTHON_CHECK_FIELDS=1.

The checks and the texts of their AssertionErrors are rosidl's. They run in a hidden subclass, made from the
field types when first needed, so that messages without checks pay nothing. An object of it claims to be of
the public class (`__class__`, names, copies, pickles, equality); only `type()` sees the difference.
"""

from __future__ import annotations

import math
from array import array
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from typing import Any, TypeAlias, cast

from ifgen_runtime.field_types import Basic, Field, Text, fields_of
from ifgen_runtime.lazy import numpy
from ifgen_runtime.message import DEFAULT, Message

Check: TypeAlias = Callable[[Any], Any]
"""Gives what to store for a value that is assigned; raises AssertionError if the field cannot have it."""

_FLOAT_LIMITS = {"float": 3.402823466e38, "double": 1.7976931348623157e308}
_set_class = vars(object)["__class__"].__set__


class InvalidArgumentsError(TypeError, AssertionError):
    """Keywords that a constructor does not know: TypeError as Python's own, AssertionError as rosidl's."""


def initialize(message: Message, arguments: dict[str, Any]) -> None:
    """Finish a constructor that was given `check_fields` or unknown keywords; `arguments` are its locals."""
    if unknown := arguments["_unknown"]:
        raise InvalidArgumentsError(f"Invalid arguments passed to constructor: {', '.join(sorted(unknown))}")
    cls = message.__class__
    switch_checks(message, True)
    for field in fields_of(cls):
        attribute = _attribute(field)
        value = arguments[attribute]
        if value is DEFAULT:
            value = default_value(field, cls)
        elif field.is_sequence and _typecode(field) and not hasattr(cls, _default_name(field)):
            value = array(
                _typecode(field), value
            )  # rosidl converts before it checks, but not where it has a default
        setattr(message, attribute, value)


def switch_checks(message: Message, on: bool) -> None:
    """Check what is assigned to the fields of this message from now on, or no longer."""
    public = message.__class__
    _set_class(message, _checking_class(public) if on else public)


def default_value(field: Field, owner: type) -> Any:
    """A new default value for a field: the declared one, or zero, empty, or a message of defaults."""
    declared = getattr(owner, _default_name(field), DEFAULT)
    if declared is not DEFAULT:
        return declared
    typecode = _typecode(field)
    if field.is_sequence:
        return array(typecode) if typecode else []
    if field.size is None:
        return _default_element(field)
    if isinstance(field.type, Basic) and typecode:
        return numpy.zeros(field.size, field.type.dtype)
    return [_default_element(field) for _ in range(field.size)]


def _default_element(field: Field) -> Any:
    return b"\0" if _element_type(field) is bytes else _element_type(field)()


def _attribute(field: Field) -> str:
    return field.slot[1:]


def _default_name(field: Field) -> str:
    return f"{field.name.upper()}__DEFAULT"


def _typecode(field: Field) -> str:
    """The array.array type code of numbers; empty for anything else."""
    return field.type.typecode if isinstance(field.type, Basic) else ""


def _element_type(field: Field) -> type:
    match field.type:
        case Text():
            return str
        case Basic(name="boolean"):
            return bool
        case Basic(name="octet"):
            return bytes
        case Basic():
            return float if field.type.is_float else int
        case message_class:
            return message_class


def _checking_class(public: type[Message]) -> type[Message]:
    """The hidden subclass of a message class: same layout, same name, all fields checked."""
    found: type[Message] | None = vars(public).get("__checking_class__")
    if found is None:
        namespace: dict[str, Any] = {
            "__slots__": (),
            "__module__": public.__module__,
            "__qualname__": public.__qualname__,
            "__doc__": public.__doc__,
            "__class__": property(lambda _: public),
            "__deepcopy__": public.__deepcopy__,
            "_check_fields": property(lambda _: True, switch_checks),
        }
        for field in fields_of(public):
            namespace[_attribute(field)] = namespace[field.name] = _checked(field, public)
        metaclass: Any = type(public)
        found = metaclass(public.__name__, (public,), namespace)
        setattr(found, "__slots__", public.__slots__)  # noqa: B010 - not the slots that it has
        setattr(public, "__checking_class__", found)  # noqa: B010 - not part of what a message class has
    return cast("type[Message]", found)


def _checked(field: Field, owner: type) -> property:
    member = getattr(owner, field.slot)
    check = _collection_check(field) if field.is_collection else _value_check(field)
    store = member.__set__

    def assign(message: Message, value: Any) -> None:
        store(message, check(value))

    return property(member.__get__, assign)


def _require(condition: bool, field: Field, expected: str) -> None:
    if not condition:
        raise AssertionError(f"The '{_attribute(field)}' {expected}")


def _value_check(field: Field) -> Check:
    match field.type:
        case Text(maximum=int(bound)):
            is_valid, expected = _is_bounded_string(bound), f"string value not longer than {bound}"
        case Basic(name="octet"):
            is_valid, expected = _is_one_byte, "of type 'bytes' or 'ByteString' with length 1"
        case Basic(name="boolean") | Text():
            return _type_check(field)
        case Basic():
            return _number_check(field, field.type)
        case message_class:
            is_valid, expected = (
                _is_message(message_class),
                f"a sub message of type '{message_class.__name__}'",
            )

    def check(value: Any) -> Any:
        _require(is_valid(value), field, f"field must be {expected}")
        return value

    return check


def _is_bounded_string(bound: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, (str, UserString)) and len(value) <= bound


def _is_one_byte(value: Any) -> bool:
    return isinstance(value, (bytes, bytearray)) and len(value) == 1


def _is_message(message_class: type) -> Callable[[Any], bool]:
    def is_message(value: Any) -> bool:
        if isinstance(value, message_class):
            return True
        # Real ROS may have brought a class of its own for the same type; its objects serve as well.
        cls = type(value)
        return cls.__name__ == message_class.__name__ and cls.__module__ == message_class.__module__

    return is_message


def _type_check(field: Field) -> Check:
    expected = _element_type(field)

    def check(value: Any) -> Any:
        _require(isinstance(value, expected), field, f"field must be of type '{expected.__name__}'")
        return value

    return check


def _number_check(field: Field, basic: Basic) -> Check:
    check_type = _type_check(field)
    in_range, range_text = _range_check(basic, "{!r}")
    article = "an" if range_text[0] in "iu" else "a"

    def check(value: Any) -> Any:
        check_type(value)
        _require(in_range(value), field, f"field must be {article} {range_text}")
        return value

    return check


def _range_check(basic: Basic, float_format: str) -> tuple[Callable[[Any], bool], str]:
    """Whether a number is in the range of a type, and how rosidl calls that range."""
    if not basic.is_float:
        low, high = basic.range
        return (
            lambda value: low <= value <= high,
            f"{'integer' if low else 'unsigned integer'} in [{low}, {high}]",
        )
    limit = _FLOAT_LIMITS[basic.name]
    text = f"{basic.name} in [{float_format.format(-limit)}, {float_format.format(limit)}]"
    return lambda value: not (value < -limit or value > limit) or math.isinf(value), text


def _collection_check(field: Field) -> Check:
    check_list = _list_check(field)
    if not isinstance(field.type, Basic) or not field.type.typecode:
        return check_list
    if field.is_sequence:
        return _array_check(field, field.type.typecode, check_list)
    return _numpy_check(field, field.type.dtype, check_list)


def _list_check(field: Field) -> Check:
    size, maximum = field.size, field.maximum
    bound = field.type.maximum if isinstance(field.type, Text) else None
    element_type, is_element, is_in_range = _element_type(field), _is_element(field), None

    expected = "field must be a set or sequence"
    if size is not None:
        expected += f" with length {size}"
    if maximum is not None:
        expected += f" with length <= {maximum}"
    if bound is not None:
        expected += f" and each string value not longer than {bound}"
    expected += f" and each value of type '{element_type.__name__}'"
    if isinstance(field.type, Basic) and field.type.typecode:
        is_in_range, range_text = _range_check(field.type, "{:f}")
        expected += f" and each {range_text}"

    def check(value: Any) -> Any:
        _require(
            isinstance(value, (Sequence, Set, UserList))
            and not isinstance(value, (str, UserString))
            and (bound is None or all(len(element) <= bound for element in cast("Sequence[Any]", value)))
            and (size is None or len(value) == size)
            and (maximum is None or len(value) <= maximum)
            and all(map(is_element, value))
            and (is_in_range is None or all(map(is_in_range, value))),
            field,
            expected,
        )
        return value

    return check


def _is_element(field: Field) -> Callable[[Any], bool]:
    expected = _element_type(field)
    if isinstance(field.type, type):
        return _is_message(expected)
    return lambda value: isinstance(value, expected)


def _array_check(field: Field, typecode: str, check_list: Check) -> Check:
    def check(value: Any) -> Any:
        if not isinstance(value, array):
            return array(typecode, check_list(value))
        _require(value.typecode == typecode, field, f"array.array() must have the type code of '{typecode}'")
        if field.maximum is not None:
            _require(len(value) <= field.maximum, field, f"array.array() must have a size <= {field.maximum}")
        return cast("Any", value)

    return check


def _numpy_check(field: Field, dtype: str, check_list: Check) -> Check:
    def check(value: Any) -> Any:
        if not isinstance(value, numpy.ndarray):
            return numpy.array(check_list(value), dtype)
        _require(value.dtype == dtype, field, f"numpy.ndarray() must have the dtype of 'numpy.{dtype}'")
        _require(value.size == field.size, field, f"numpy.ndarray() must have a size of {field.size}")
        return cast("Any", value)

    return check
