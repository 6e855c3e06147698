"""Types and values of fields as a lock file writes them: one text for each, and back.

The notation is that of .msg files, with two differences. Types of messages always name their package, and
their folder where it is not `msg`. Values are JSON, because any string has one spelling there. `char` is the
character of an .idl file; the `char` of a .msg file is a `uint8`.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache
from typing import Final

from ifgen.definition import names
from ifgen.definition.described.values import Value, from_plain, plain
from ifgen.definition.literals import BadValue
from ifgen.definition.spelling import PRIMITIVES, spelled
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    ValueType,
)
from ifgen.reading.packages import FOLDERS

_PRIMITIVES: Final[dict[str, ValueType]] = {**PRIMITIVES, "char": BasicType("char")}
_TYPE: Final = re.compile(
    r"(?P<base>[A-Za-z][A-Za-z0-9_/]*)(?:<=(?P<bound>[1-9][0-9]{0,19}))?"
    r"(?:\[(?P<upto><=)?(?P<size>[1-9][0-9]{0,19})?\])?"
)


def type_text(type_: FieldType) -> str:
    """The text of a type."""
    if isinstance(type_, Array | BoundedSequence | UnboundedSequence):
        return type_text(type_.value_type) + spelled(type_)[len(spelled(type_.value_type)) :]
    if isinstance(type_, NamespacedType) and type_.folder != "msg":
        return type_.type_name
    return spelled(type_)


@lru_cache(maxsize=4096)
def read_type(text: str) -> FieldType | None:
    """The type that a text stands for; None if it is none. Whether a message exists is not looked at."""
    match = _TYPE.fullmatch(text)
    value_type = _value_type(match["base"], match["bound"]) if match else None
    if match is None or value_type is None or "[" not in text:
        return value_type
    if match["size"] is None:
        return None if match["upto"] else UnboundedSequence(value_type)
    return (BoundedSequence if match["upto"] else Array)(value_type, int(match["size"]))


def _value_type(base: str, bound: str | None) -> ValueType | None:
    if bound is not None:
        if base == "string":
            return BoundedString(int(bound))
        return BoundedWString(int(bound)) if base == "wstring" else None
    if base in _PRIMITIVES:
        return _PRIMITIVES[base]
    package, *folder, name = base.split("/") if "/" in base else ("", base)
    if len(folder) > 1 or not names.is_package_name(package) or not is_type_name(name):
        return None
    if folder and folder[0] not in FOLDERS:
        return None
    return NamespacedType(package, folder[0] if folder else "msg", name)


def is_type_name(name: str) -> bool:
    """Whether a message may have this name, in a .msg or an .idl file."""
    return names.is_message_name(name) or names.is_idl_type_name(name)


def value_text(value: Value, type_: FieldType) -> str:
    """The text of a constant's value or of a default, for a field or a constant of this type."""
    return json.dumps(plain(value, type_))


def read_value(text: str, type_: FieldType) -> Value:
    """The value that a text stands for in a field or a constant of this type. Raises BadValue."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise BadValue("expected a value in JSON") from None
    return from_plain(value, type_)
