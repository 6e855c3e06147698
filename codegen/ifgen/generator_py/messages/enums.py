"""The constants of a message that are the values of a field.

The rule: an integer field owns the constants of its own type whose names begin with the field's name in
capitals and an underscore: `int8 STATUS_ABORTED=6` belongs to `int8 status`. If two fields fit, the longer
name wins. A field whose comment says `[@enum MODE OTHER]` owns those that begin with `MODE_` and `OTHER_`
instead, and two fields may say so of the same constants. At least two constants make an enumeration. Members
drop the common part (`ABORTED`) if the rest is a name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.meaning.reading import meaning_of, named_constants
from ifgen.definition.names import attribute_name
from ifgen.definition.types import ValueType, element_of
from ifgen.generator_py.messages.context import EnumText
from ifgen.generator_py.names import enum_name
from ifgen.generator_py.text import docstring


def enums(message: Message, spelling: Callable[[str], str] = str) -> tuple[EnumText, ...]:
    """The enumerations of a message, in the order of the fields; `spelling` spells names of Python."""
    found = list(_enums(message, spelling))
    if not found:
        return ()
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
    fields = {(_prefix(field), element_of(field.type)): field for field in reversed(message.fields)}
    owned: dict[str, list[Constant]] = {}
    for constant in message.constants:
        owner = _owner(constant, fields)
        if owner is not None:
            owned.setdefault(owner.name, []).append(constant)
    for field in message.fields:
        constants = _tagged(field, message) or owned.get(field.name, ())
        if len(constants) > 1:
            yield field, tuple(constants)


def _tagged(field: Field, message: Message) -> tuple[Constant, ...]:
    """The constants that `[@enum NAME]` names, of the type of the field."""
    constants = named_constants(field, message) if _has_tag(field) else ()
    return constants if all(each.type == element_of(field.type) for each in constants) else ()


def _has_tag(field: Field) -> bool:
    return "@enum" in field.documentation or (field.unit is not None and "@enum" in field.unit)


def _enums(message: Message, spelling: Callable[[str], str]) -> Iterator[EnumText]:
    for field, constants in values(message):
        prefixes = _prefixes(field)
        names = " and ".join(f"`{prefix}...`" for prefix in prefixes)
        text = f"The values of `{field.name}`, as an enumeration of the constants {names}."
        yield EnumText(
            name=enum_name(field),
            base=spelling("IntEnum"),
            view=spelling("enum_view"),
            members=tuple(_members(constants, prefixes)),
            docstring=docstring(text, indent=12),
        )


def _owner(constant: Constant, fields: Mapping[tuple[str, ValueType], Field]) -> Field | None:
    """The field with the longest prefix that the constant has; `fields` has them by prefix and type."""
    if not isinstance(constant.value, int) or isinstance(constant.value, bool):
        return None
    end = len(constant.name)
    while (end := constant.name.rfind("_", 0, end)) >= 0:
        field = fields.get((constant.name[: end + 1], constant.type))
        if field is not None:
            return field
    return None


def _prefix(field: Field) -> str:
    return f"{field.name.upper()}_"


def _prefixes(field: Field) -> tuple[str, ...]:
    """The prefixes of the constants that a field owns, of which its members keep none."""
    named = meaning_of(field).enum if _has_tag(field) else ()
    return tuple(f"{name}_" for name in named) or (_prefix(field),)


def _members(constants: Sequence[Constant], prefixes: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The name and the value of each member; with several prefixes two may have one short name."""
    short = [_short(constant.name, prefixes) for constant in constants]
    for constant, name in zip(constants, short, strict=True):
        yield constant.name if short.count(name) > 1 else name, repr(constant.value)


def _short(name: str, prefixes: Sequence[str]) -> str:
    prefix = next((each for each in prefixes if name.startswith(each)), "")
    short = name.removeprefix(prefix)
    return short if short.isidentifier() else name
