"""From a value of an old type to one of a new type, as Python text, or a question that a person answers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import Final, TypeAlias

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.meaning.reading import meaning_of
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
from ifgen.evolution.values import same_constant
from ifgen.generator_py.messages.context import values
from ifgen.wire.program import NUMBERS

Converter: TypeAlias = Callable[[NamespacedType, NamespacedType], "str | None"]
"""The function that converts messages of one type to another; empty if they are the same, None if none."""

_EXACT: Final = {"float": 24, "double": 53}
"""Bits of the integers that a number holds exactly."""


@dataclass(frozen=True, slots=True)
class Conversion:
    """The text of a converted value. `function` converts the messages in it; empty if there are none.

    `is_each` is true if that is called for each element, and `is_wrapped` if the value became a sequence.
    """

    text: str
    function: str = ""
    is_each: bool = False
    is_wrapped: bool = False


def convert(old: FieldType, new: FieldType, value: str, converter: Converter) -> Conversion | None:
    """The conversion of `value`; None if a person has to decide."""
    if not isinstance(old, CollectionType):
        element = new.value_type if isinstance(new, CollectionType) else new
        found = _converted(old, element, value, converter)
        if found is None or not isinstance(new, CollectionType):
            return found
        return Conversion(f"[{found.text}]", found.function, is_wrapped=True) if _fits(1, 1, new) else None
    if not isinstance(new, CollectionType):
        return None
    size = old.size if isinstance(old, Array) else 0
    most = old.maximum_size if isinstance(old, BoundedSequence) else size or inf
    return _each(old, new, value, converter) if _fits(size, most, new) else None


def _fits(least: float, most: float, new: CollectionType) -> bool:
    """Whether the new type takes every number of elements from `least` to `most`."""
    match new:
        case Array(size=size):
            return least == most == size
        case BoundedSequence(maximum_size=bound):
            return most <= bound
        case UnboundedSequence():
            return True


def _each(old: CollectionType, new: CollectionType, value: str, converter: Converter) -> Conversion | None:
    found = _converted(old.value_type, new.value_type, "item", converter)
    if found is None:
        return None
    if _is_numeric(old.value_type) and _is_numeric(new.value_type):
        is_same = old.value_type == new.value_type and isinstance(old, Array) == isinstance(new, Array)
        return Conversion(value if is_same else f"{value}.tolist()")
    if found.text == "item":
        return Conversion(value)
    return Conversion(f"[{found.text} for item in {value}]", found.function, is_each=True)


def _is_numeric(type_: ValueType) -> bool:
    """Whether arrays and sequences of a type are arrays of numbers, and not lists."""
    return isinstance(type_, BasicType) and bool(NUMBERS[type_.typename].typecode)


def _converted(old: ValueType, new: ValueType, value: str, converter: Converter) -> Conversion | None:
    match old, new:
        case (BasicType(), BasicType()):
            text = _number(old.typename, new.typename, value)
            return None if text is None else Conversion(text)
        case (NamespacedType(), NamespacedType()):
            function = converter(old, new)
            return (
                None
                if function is None
                else Conversion(f"{function}({value})" if function else value, function)
            )
        case ((BasicType() | NamespacedType()), _) | (_, (BasicType() | NamespacedType())):
            return None
        case _:
            return Conversion(value) if _most(new) >= _most(old) else None


def _number(old: str, new: str, value: str) -> str | None:
    if old == new or (old, new) == ("float", "double"):
        return value
    if old == "octet" and new == "uint8":
        return f"{value}[0]"
    if old == "uint8" and new == "octet":
        return f"bytes([{value}])"
    if "int" not in old or "char" in {old, new}:
        return None
    signed, bits = not old.startswith("u"), int(old.removeprefix("u").removeprefix("int"))
    if new in _EXACT:
        return f"float({value})" if bits - signed <= _EXACT[new] else None
    if "int" not in new:
        return None
    new_signed, new_bits = not new.startswith("u"), int(new.removeprefix("u").removeprefix("int"))
    return value if new_signed >= signed and new_bits - new_signed >= bits - signed else None


def _most(type_: ValueType) -> float:
    match type_:
        case BoundedString(bound) | BoundedWString(bound):
            return bound
        case UnboundedString() | UnboundedWString():
            return inf
        case _:
            raise AssertionError(type_)


_EXPONENTS: Final = {
    **{"G": 9, "M": 6, "k": 3, "h": 2, "": 0, "d": -1, "c": -2, "m": -3},
    **{"u": -6, "\u00b5": -6, "\u03bc": -6, "n": -9, "p": -12},
}
_BASES: Final = "m g s A K N J W V F T H C L Pa Hz rad bar Ah Wh eV Ohm \u03a9".split()  # noqa: SIM905
_SPELLINGS: Final = {"sec": "s", "msec": "ms", "usec": "us", "nsec": "ns", "meter": "m", "metre": "m"}
_SHOWN: Final = 3


def question(source: Field, target: Field, of_source: Message, of_target: Message, value: str) -> str:
    """The question whether a field means what another does, whose values it takes; empty if there is none.

    `value` is the value of the source in Python, and the messages are those that the fields are of. A type
    description tells of no constants, and has no source.
    """
    if (one := _unit(source)) and (other := _unit(target)) and one != other:
        hint = _factor(one, other, source, value)
        in_target, in_source = meaning_of(target).unit, meaning_of(source).unit
        return f"`{target.name}` is in {in_target}, and `{value}` in {in_source}{hint}"
    constants = _constants_of(target, of_target)
    is_told = bool(constants) or (of_target.source is not None and not of_target.constants)
    changed = list(_changed(_constants_of(source, of_source), constants, value)) if is_told else []
    if changed:
        more = f"; and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
        return f"`{target.name}` has other constants: {'; '.join(changed[:_SHOWN])}{more}"
    return ""


def _unit(field: Field) -> str:
    """The unit, spelled alike: `A.h` and `Ah` are one. Lock files and descriptions know none."""
    text = re.sub(r"[\s.*\u00b7]", "", meaning_of(field).unit or "")
    return _SPELLINGS.get(text, text)


def _factor(old: str, new: str, field: Field, value: str) -> str:
    """The conversion, where it is a factor that is known."""
    if isinstance(field.type, CollectionType):
        return ""
    if (old, new) == ("deg", "rad"):
        return f": `math.radians({value})`?"
    if (old, new) == ("rad", "deg"):
        return f": `math.degrees({value})`?"
    for base in _BASES:
        before, after = (unit.removesuffix(base) if unit.endswith(base) else None for unit in (old, new))
        if before in _EXPONENTS and after in _EXPONENTS:
            power = _EXPONENTS[before] - _EXPONENTS[after]
            return f": `{value} {'*' if power > 0 else '/'} {10 ** abs(power)}`?"
    return ""


def _constants_of(field: Field, message: Message) -> tuple[Constant, ...]:
    """The constants that are values of a field.

    They are those of its enumeration. In a message with a single integer field it has all of the same type.
    """
    owned = next((constants for owner, constants in values(message) if owner.name == field.name), ())
    element = field.type.value_type if isinstance(field.type, CollectionType) else field.type
    alone = sum(_is_integer(other) for other in message.fields) == 1 and _is_integer(field)
    return owned or tuple(c for c in message.constants if alone and c.type == element)


def _is_integer(field: Field) -> bool:
    element = field.type.value_type if isinstance(field.type, CollectionType) else field.type
    return isinstance(element, BasicType) and "int" in element.typename


def _changed(source: Sequence[Constant], target: Sequence[Constant], value: str) -> Iterator[str]:
    """The values that have a name in the source and another one in the target, or none."""
    names = {constant.name: constant for constant in target}
    for constant in source:
        beside = names.get(constant.name)
        if beside is not None and not same_constant(constant, beside):
            yield f"{constant.name} is {constant.value!r} in `{value}`, and {beside.value!r} here"
        elif beside is None:
            same = next((c.name for c in target if same_constant(constant, c)), "unknown")
            yield f"{constant.value!r} is {constant.name} in `{value}`, and {same} here"
