"""A field in Python: its annotation, and how it is made, converted, compared, copied and shown."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Final, TypeAlias

from ifgen.definition.interfaces import Field, Scalar
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
    element_of,
)
from ifgen.generator_py.imports import Scope
from ifgen.wire.program import NUMBERS, Number

Reference: TypeAlias = Callable[[NamespacedType], str]
"""The name of a message class in the module."""

_CLASSES: Final = {"boolean": "bool", "octet": "bytes", "char": "str", "float": "float", "double": "float"}
_ZEROS: Final = {
    "boolean": "False",
    "octet": repr(bytes(1)),
    "char": repr(chr(0)),
    "float": "0.0",
    "double": "0.0",
}


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


def python_field(field: Field, attribute: str, scope: Scope, reference: Reference) -> PythonField:
    """A field in Python; `attribute` is its public name there."""
    text = _FieldText(field, attribute, scope, reference)
    match field.type:
        case Array(BasicType(typename), size) if NUMBERS[typename].typecode:
            return text.numeric_array(NUMBERS[typename], size)
        case BoundedSequence(BasicType(typename)) | UnboundedSequence(BasicType(typename)) if NUMBERS[
            typename
        ].typecode:
            return text.numeric_sequence(NUMBERS[typename])
        case Array(value_type, size):
            is_message = isinstance(value_type, NamespacedType)
            rest = f" for _ in {scope('range')}({size})]" if is_message else f"] * {size}"
            return text.list(value_type, f"[{text.zero(value_type)}{rest}")
        case BoundedSequence(value_type) | UnboundedSequence(value_type):
            return text.list(value_type, "[]")
        case NamespacedType() as message_type:
            return text.message(reference(message_type))
        case value_type:
            return text.scalar(value_type)


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
    return element_of(type_) == BasicType("float")


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


def zero_literal(type_: ValueType) -> str | None:
    """The value of a new message's field as a literal; None for a message."""
    if isinstance(type_, NamespacedType):
        return None
    return _ZEROS.get(type_.typename, "0") if isinstance(type_, BasicType) else '""'


class _FieldText:
    """The text of one field, by the kind of its type; `private` reaches the value whatever `name` does."""

    def __init__(self, field: Field, name: str, scope: Scope, reference: Reference) -> None:
        self._field = field
        self._name = name
        self._private = f"_{name}"
        self._scope = scope
        self._reference = reference

    def scalar(self, type_: ValueType) -> PythonField:
        """A basic value or a string."""
        annotation = self._element_annotation(type_)
        default = self._declared(self.zero(type_))
        own_class = f"(value := message.{self._private}).__class__ is {annotation}"
        return self._stored(
            annotation=annotation,
            default=default,
            fresh=default,
            initial=self._name,
            copied=f"value if {own_class} else {self._scope('copied_other')}(value, memo)",
        )

    def message(self, reference: str) -> PythonField:
        """A message."""
        deepcopy = f"{self._scope.nested('deepcopy', reference)}(value, memo)"
        other = f"{self._scope('copied_other')}(value, memo)"
        own_class = f"(value := message.{self._private}).__class__ is {reference}"
        fresh = f"{self._scope.nested('default', reference)}()"
        return self._own_object(reference, fresh, f"{deepcopy} if {own_class} else {other}")

    def list(self, type_: ValueType, empty: str) -> PythonField:
        """A list; `empty` is what a new message has where no default is declared."""
        element = self._element_annotation(type_)
        deepcopy = self._scope.nested("deepcopy", element) if isinstance(type_, NamespacedType) else "None"
        copied = f"{self._scope('copied_list')}(message.{self._private}, {element}, {deepcopy}, memo)"
        return self._own_object(f"{self._scope('list')}[{element}]", self._declared(empty), copied)

    def numeric_sequence(self, number: Number) -> PythonField:
        """An array.array."""
        scope, code = self._scope, number.typecode
        array, element, arrays = scope("array"), self._number_class(number), scope("arrays")
        python = self._numbers(
            annotation=f"{array}[{element}]",
            parameter=f"{scope('Iterable')}[{element}] | {arrays}.Buffer",
            new=f'{array}("{code}")',
            from_items=f'{scope("new_array")}("{code}", {{}})',
            from_other=f'{arrays}.array_of("{code}", {{}})',
        )
        python = replace(python, shown=f"{{{scope('array_repr')}(self.{self._name})}}")
        if code in "fd":  # array.array compares floats as objects, integers as memory
            return python
        return replace(python, differs=f"{scope('unequal')}(self.{self._private}, other.{self._private})")

    def numeric_array(self, number: Number, size: int) -> PythonField:
        """A numpy array."""
        scope = self._scope
        numpy, element, ndarray = scope("numpy"), self._number_class(number), scope("NDArray")
        dtype, arrays = f"{numpy}.{number.dtype}", scope("arrays")
        return self._numbers(
            annotation=f"{ndarray}[{dtype}]",
            parameter=f"{scope('Sequence')}[{element}] | {arrays}.AnyArray | {arrays}.Buffer",
            # The dtype of zeros() is float64 unless it is given, which takes longer.
            new=f"{numpy}.zeros({size})" if number.dtype == "float64" else f"{numpy}.zeros({size}, {dtype})",
            from_items=f"{numpy}.array({{}}, {dtype})",
            from_other=f"{arrays}.ndarray_of({dtype}, {{}})",
        )

    def zero(self, type_: ValueType) -> str:
        """The value of this type in a new message."""
        if isinstance(type_, NamespacedType):
            return f"{self._scope.nested('default', self._reference(type_))}()"
        return zero_literal(type_) or ""

    def _numbers(
        self, *, annotation: str, parameter: str, new: str, from_items: str, from_other: str
    ) -> PythonField:
        """A field that converts its value to its own array.

        Most values are lists and the like. The test for them is here because a call takes longer than the
        test.
        """
        name, private, iterables = self._name, self._private, self._scope("ITERABLES")

        def converted(value: str) -> str:
            read, taken = from_items.format(value), from_other.format(value)
            return f"{read} if {value}.__class__ in {iterables} else {taken}"

        fresh = self._declared(new)
        copied = f"{self._scope('copied_array')}(message.{private}, memo)"
        return replace(
            self._own_object(annotation, fresh, copied),
            slot=private,
            parameter=parameter,
            initial=f"{fresh} if {name} is {self._scope('DEFAULT')} else {converted(name)}",
            converted=converted("value"),
            differs=f"memoryview(self.{private}) != memoryview(other.{private})",
        )

    def _own_object(self, annotation: str, fresh: str, copied: str) -> PythonField:
        """A field whose default each message makes for itself; it holds what it is given."""
        default = self._scope("DEFAULT")
        initial = f"{fresh} if {self._name} is {default} else {self._name}"
        return self._stored(
            annotation=annotation, default=default, fresh=fresh, initial=initial, copied=copied
        )

    def _stored(self, *, annotation: str, default: str, fresh: str, initial: str, copied: str) -> PythonField:
        """A field that holds what it is given."""
        return PythonField(
            slot=self._name,
            annotation=annotation,
            parameter=annotation,
            default=default,
            fresh=fresh,
            initial=initial,
            converted=None,
            differs=f"self.{self._private} != other.{self._private}",
            copied=copied,
            shown=f"{{self.{self._name}!r}}",
        )

    def _declared(self, otherwise: str) -> str:
        """The declared default; if there is none, this text."""
        return otherwise if self._field.default_value is None else default_literal(self._field, self._scope)

    def _element_annotation(self, type_: ValueType) -> str:
        if isinstance(type_, NamespacedType):
            return self._reference(type_)
        return self._scope(_CLASSES.get(type_.typename, "int") if isinstance(type_, BasicType) else "str")

    def _number_class(self, number: Number) -> str:
        return self._scope("float" if number.typecode in "fd" else "int")
