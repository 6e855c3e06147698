"""A field in Python: its annotation, and how it is made, converted, compared, copied and shown."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import Any, TypeAlias

from ifgen.definition.interfaces import Field, Scalar
from ifgen.definition.names import attribute_name
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)
from ifgen.generator_py.codec.program import NUMBERS, Number
from ifgen.generator_py.imports import Scope
from ifgen.generator_py.names import slot_name

Reference: TypeAlias = Callable[[NamespacedType], str]
"""The name of a message class in the module."""


@dataclass(frozen=True, slots=True)
class PythonField:
    """Python text for one field.

    `slot` holds the value: the public name, or the private one where a property converts. `default` is the
    text of the parameter's default, `fresh` makes a new default value, and `initial` is what the constructor
    stores. `converted` converts `value`; None where it is stored as it is. `differs` compares `self` and
    `other`, `copied` copies from `message`, and `shown` is the field's part of the repr, in an f-string.
    """

    slot: str
    annotation: str
    parameter: str
    default: str
    fresh: str
    initial: str
    converted: str | None
    differs: str
    copied: str
    shown: str


def python_field(field: Field, scope: Scope, reference: Reference) -> PythonField:
    """A field in Python."""
    match field.type:
        case Array(BasicType(typename), size) if NUMBERS[typename].typecode:
            return _numeric_array(field, NUMBERS[typename], size, scope)
        case BoundedSequence(BasicType(typename), _) | UnboundedSequence(BasicType(typename)) if NUMBERS[
            typename
        ].typecode:
            return _numeric_sequence(field, NUMBERS[typename], scope)
        case Array(value_type, size):
            made = f"[{_zero(value_type, scope, reference)}"
            is_message = isinstance(value_type, NamespacedType)
            made += f" for _ in {scope('range')}({size})]" if is_message else f"] * {size}"
            return _list(field, value_type, made, scope, reference)
        case BoundedSequence(value_type, _) | UnboundedSequence(value_type):
            return _list(field, value_type, "[]", scope, reference)
        case NamespacedType() as message_type:
            return _message(field, reference(message_type), scope)
        case value_type:
            return _scalar(field, value_type, scope, reference)


def rosidl_text(type_: FieldType) -> str:
    """A type as rosidl spells it in `get_fields_and_field_types()`: `sequence<string<5>, 3>`."""
    match type_:
        case BasicType(typename):
            return typename
        case UnboundedString():
            return "string"
        case UnboundedWString():
            return "wstring"
        case BoundedString(bound):
            return f"string<{bound}>"
        case BoundedWString(bound):
            return f"wstring<{bound}>"
        case NamespacedType(package, _, name):
            return f"{package}/{name}"
        case Array(value_type, size):
            return f"{rosidl_text(value_type)}[{size}]"
        case BoundedSequence(value_type, maximum):
            return f"sequence<{rosidl_text(value_type)}, {maximum}>"
        case UnboundedSequence(value_type):
            return f"sequence<{rosidl_text(value_type)}>"


def literal(value: Scalar, scope: Scope) -> str:
    """A value as a Python expression."""
    if isinstance(value, float) and value - value != 0.0:  # inf or nan
        return f"{scope('float')}('{value}')"
    return repr(value)


def is_float32(type_: FieldType) -> bool:
    """Whether a field of this type holds a float32, or several of them."""
    return (type_.value_type if isinstance(type_, CollectionType) else type_) == BasicType("float")


def default_value(field: Field) -> Scalar | tuple[Scalar, ...] | None:
    """The declared default; what is too large for a float32 is infinite, as in rosidl's C code."""
    value = field.default_value
    if not is_float32(field.type):
        return value
    return tuple(map(_as_float32, value)) if isinstance(value, tuple) else _as_float32(value)


def _as_float32(value: Scalar | None) -> Any:
    """The number as it was written, or infinity."""
    rounded = array("f", [value])[0] if isinstance(value, float) else value
    return rounded if rounded in {inf, -inf} else value


def default_literal(field: Field, scope: Scope) -> str:
    """The declared default of a field as an expression that makes a new one."""
    value = default_value(field)
    if not isinstance(value, tuple):
        assert value is not None
        return literal(value, scope)
    elements = ", ".join(literal(element, scope) for element in value)
    match field.type:
        case Array(BasicType(typename)) if NUMBERS[typename].typecode:
            return f"{scope('numpy')}.array([{elements}], {scope('numpy')}.{NUMBERS[typename].dtype})"
        case BoundedSequence(BasicType(typename), _) | UnboundedSequence(BasicType(typename)) if NUMBERS[
            typename
        ].typecode:
            return f'{scope("array")}("{NUMBERS[typename].typecode}", [{elements}])'
        case _:
            return f"[{elements}]"


def _element_annotation(type_: ValueType, scope: Scope, reference: Reference) -> str:
    match type_:
        case NamespacedType():
            return reference(type_)
        case BasicType("boolean"):
            return scope("bool")
        case BasicType("octet"):
            return scope("bytes")
        case BasicType("char"):
            return scope("str")
        case BasicType("float" | "double"):
            return scope("float")
        case BasicType():
            return scope("int")
        case _:
            return scope("str")


def _zero(type_: ValueType, scope: Scope, reference: Reference) -> str:
    match type_:
        case NamespacedType():
            return f"{scope.nested('default', reference(type_))}()"
        case BasicType("boolean"):
            return "False"
        case BasicType("octet"):
            return repr(bytes(1))
        case BasicType("char"):
            return repr(chr(0))
        case BasicType("float" | "double"):
            return "0.0"
        case BasicType():
            return "0"
        case _:
            return '""'


def _scalar(field: Field, type_: ValueType, scope: Scope, reference: Reference) -> PythonField:
    name, private = attribute_name(field), slot_name(field)
    annotation = _element_annotation(type_, scope, reference)
    declared = field.default_value is not None
    default = default_literal(field, scope) if declared else _zero(type_, scope, reference)
    other = f"{scope('copied_other')}(value, memo)"
    return PythonField(
        slot=name,
        annotation=annotation,
        parameter=annotation,
        default=default,
        fresh=default,
        initial=name,
        converted=None,
        differs=f"self.{private} != other.{private}",
        copied=f"value if (value := message.{private}).__class__ is {annotation} else {other}",
        shown=f"{{self.{name}!r}}",
    )


def _message(field: Field, reference: str, scope: Scope) -> PythonField:
    deepcopy = f"{scope.nested('deepcopy', reference)}(value, memo)"
    other = f"{scope('copied_other')}(value, memo)"
    own_class = f"(value := message.{slot_name(field)}).__class__ is {reference}"
    return _own_object(
        field,
        scope,
        annotation=reference,
        fresh=f"{scope.nested('default', reference)}()",
        copied=f"{deepcopy} if {own_class} else {other}",
    )


def _list(field: Field, value_type: ValueType, made: str, scope: Scope, reference: Reference) -> PythonField:
    element = _element_annotation(value_type, scope, reference)
    deepcopy = scope.nested("deepcopy", element) if isinstance(value_type, NamespacedType) else "None"
    return _own_object(
        field,
        scope,
        annotation=f"{scope('list')}[{element}]",
        fresh=made if field.default_value is None else default_literal(field, scope),
        copied=f"{scope('copied_list')}(message.{slot_name(field)}, {element}, {deepcopy}, memo)",
    )


def _own_object(field: Field, scope: Scope, *, annotation: str, fresh: str, copied: str) -> PythonField:
    """A field whose default each message makes for itself; it holds what it is given."""
    name, private, default = attribute_name(field), slot_name(field), scope("DEFAULT")
    return PythonField(
        slot=name,
        annotation=annotation,
        parameter=annotation,
        default=default,
        fresh=fresh,
        initial=f"{fresh} if {name} is {default} else {name}",
        converted=None,
        differs=f"self.{private} != other.{private}",
        copied=copied,
        shown=f"{{self.{name}!r}}",
    )


def _numeric_sequence(field: Field, number: Number, scope: Scope) -> PythonField:
    array, element, arrays = scope("array"), _number_annotation(number, scope), scope("arrays")
    python = _numbers(
        field,
        scope,
        annotation=f"{array}[{element}]",
        parameter=f"{scope('Iterable')}[{element}] | {arrays}.Buffer",
        new=f'{array}("{number.typecode}")',
        from_items=f'{scope("new_array")}("{number.typecode}", {{}})',
        from_other=f'{arrays}.array_of("{number.typecode}", {{}})',
    )
    shown = f"{{{scope('array_repr')}(self.{attribute_name(field)})}}"
    # array.array compares floats as objects, integers as memory.
    differs = _memory_differs(field) if number.typecode in "fd" else _integers_differ(field, scope)
    return replace(python, shown=shown, differs=differs)


def _numeric_array(field: Field, number: Number, size: int, scope: Scope) -> PythonField:
    numpy, element, ndarray = scope("numpy"), _number_annotation(number, scope), scope("NDArray")
    dtype, arrays = f"{numpy}.{number.dtype}", scope("arrays")
    python = _numbers(
        field,
        scope,
        annotation=f"{ndarray}[{dtype}]",
        parameter=f"{scope('Sequence')}[{element}] | {arrays}.AnyArray | {arrays}.Buffer",
        # The dtype of zeros() is float64 unless it is given, which takes longer.
        new=f"{numpy}.zeros({size})" if number.dtype == "float64" else f"{numpy}.zeros({size}, {dtype})",
        from_items=f"{numpy}.array({{}}, {dtype})",
        from_other=f"{arrays}.ndarray_of({dtype}, {{}})",
    )
    return replace(python, differs=_memory_differs(field))


def _numbers(
    field: Field,
    scope: Scope,
    *,
    annotation: str,
    parameter: str,
    new: str,
    from_items: str,
    from_other: str,
) -> PythonField:
    """A field that converts its value to its own array.

    Most values are lists and the like. The test for them is here because a call takes longer than the test.
    """
    name, private, iterables = attribute_name(field), slot_name(field), scope("ITERABLES")

    def converted(value: str) -> str:
        read, taken = from_items.format(value), from_other.format(value)
        return f"{read} if {value}.__class__ in {iterables} else {taken}"

    fresh = new if field.default_value is None else default_literal(field, scope)
    copied = f"{scope('copied_array')}(message.{private}, memo)"
    return replace(
        _own_object(field, scope, annotation=annotation, fresh=fresh, copied=copied),
        slot=private,
        parameter=parameter,
        initial=f"{fresh} if {name} is {scope('DEFAULT')} else {converted(name)}",
        converted=converted("value"),
    )


def _memory_differs(field: Field) -> str:
    private = slot_name(field)
    return f"memoryview(self.{private}) != memoryview(other.{private})"


def _integers_differ(field: Field, scope: Scope) -> str:
    private = slot_name(field)
    return f"{scope('unequal')}(self.{private}, other.{private})"


def _number_annotation(number: Number, scope: Scope) -> str:
    return scope("float") if number.typecode in "fd" else scope("int")
