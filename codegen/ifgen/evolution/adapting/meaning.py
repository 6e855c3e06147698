"""The meaning of a value besides its type: its unit, and the constants that it is one of."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.types import BasicType, CollectionType
from ifgen.evolution.python_values import same_constant
from ifgen.generator_py.messages.enums import values

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
        return f"`{target.name}` is in {target.unit}, and `{value}` in {source.unit}{hint}"
    constants = _constants_of(target, of_target)
    is_told = bool(constants) or (of_target.source is not None and not of_target.constants)
    changed = list(_changed(_constants_of(source, of_source), constants, value)) if is_told else []
    if changed:
        more = f"; and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
        return f"`{target.name}` has other constants: {'; '.join(changed[:_SHOWN])}{more}"
    return ""


def _unit(field: Field) -> str:
    """The unit, spelled alike: `A.h` and `Ah` are one. Lock files and descriptions know none."""
    text = re.sub(r"[\s.*\u00b7]", "", field.unit or "")
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
