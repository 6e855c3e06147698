"""The constants of a message that are the values of a field.

The rule: an integer field owns the constants of its own type whose names begin with the field's name in
capitals and an underscore: `int8 STATUS_ABORTED=6` belongs to `int8 status`. If two fields fit, the longer
name wins. At least two constants make an enumeration. Members drop the common part (`ABORTED`) if the rest is
a name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.names import attribute_name
from ifgen.definition.types import Array, BoundedSequence, FieldType, UnboundedSequence
from ifgen.generator_py.messages.context import EnumText
from ifgen.generator_py.messages.docstrings import docstring
from ifgen.generator_py.names import enum_name


def enums(message: Message, spelling: Callable[[str], str] = str) -> tuple[EnumText, ...]:
    """The enumerations of a message, in the order of the fields; `spelling` spells names of Python."""
    found = list(_enums(message, spelling))
    # `a_1` and `a1` would have the same name: neither gets it. In an .idl file a field or a constant may have
    # it.
    names = Counter(enum.name for enum in found)
    names.update(attribute_name(field) for field in message.fields)
    names.update(constant.name for constant in message.constants)
    return tuple(enum for enum in found if names[enum.name] == 1)


def values(message: Message) -> Iterator[tuple[Field, tuple[Constant, ...]]]:
    """The fields that own constants, two or more, and these."""
    if not message.constants:
        return
    fields = {(_prefix(field), _element_type(field)): field for field in reversed(message.fields)}
    owned: dict[str, list[Constant]] = {}
    for constant in message.constants:
        owner = _owner(constant, fields)
        if owner is not None:
            owned.setdefault(owner.name, []).append(constant)
    for field in message.fields:
        constants = owned.get(field.name, ())
        if len(constants) > 1:
            yield field, tuple(constants)


def _enums(message: Message, spelling: Callable[[str], str]) -> Iterator[EnumText]:
    for field, constants in values(message):
        text = f"The values of `{field.name}`, as an enumeration of the constants `{_prefix(field)}...`."
        yield EnumText(
            name=enum_name(field),
            base=spelling("IntEnum"),
            view=spelling("enum_view"),
            members=tuple((_member_name(constant, field), repr(constant.value)) for constant in constants),
            docstring=docstring(text, indent=12),
        )


def _owner(constant: Constant, fields: Mapping[tuple[str, FieldType], Field]) -> Field | None:
    """The field with the longest prefix that the constant has; `fields` has them by prefix and type."""
    if not isinstance(constant.value, int) or isinstance(constant.value, bool):
        return None
    end = len(constant.name)
    while (end := constant.name.rfind("_", 0, end)) >= 0:
        field = fields.get((constant.name[: end + 1], constant.type))
        if field is not None:
            return field
    return None


def _element_type(field: Field) -> FieldType:
    if isinstance(field.type, Array | BoundedSequence | UnboundedSequence):
        return field.type.value_type
    return field.type


def _prefix(field: Field) -> str:
    return f"{field.name.upper()}_"


def _member_name(constant: Constant, field: Field) -> str:
    short = constant.name.removeprefix(_prefix(field))
    return short if short.isidentifier() else constant.name
