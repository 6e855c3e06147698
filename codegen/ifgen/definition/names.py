"""The names that rosidl allows, and the names that it derives from them."""

from __future__ import annotations

import re
from functools import lru_cache
from keyword import iskeyword
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ifgen.definition.interfaces import Field

PLACEHOLDER: Final = "structure_needs_at_least_one_member"
"""The field that IDL, type hash and wire have in place of no fields at all."""

# These say what rosidl_adapter's patterns say (no two underscores in a row, none at the end) without the
# nested repetition that makes one of those take exponential time.
_LOWER: Final = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
_UPPER: Final = re.compile(r"[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)*")
_CAMEL: Final = re.compile(r"[A-Z][A-Za-z0-9]*")
_IDL_TYPE: Final = re.compile(r"[A-Z][A-Za-z0-9_]*")

# Public names that a generated class or its constructor needs for itself.
_RESERVED_ATTRIBUTES: Final = frozenset({"self", "check_fields", "get_fields_and_field_types"})

# Stripped once each, in this order, before the rest is looked at.
_RESERVED_SUFFIXES: Final = ("_Request", "_Response", "_Goal", "_Result", "_Feedback")

_WORD_START: Final = re.compile(r"(.)([A-Z][a-z]+)")
_CASE_CHANGE: Final = re.compile(r"([a-z0-9])([A-Z])")


def is_package_name(name: str) -> bool:
    """Whether a package may have this name: lower case, digits and single underscores."""
    return _LOWER.fullmatch(name) is not None


is_field_name = is_package_name
"""Whether a field may have this name; the rule is the one for packages."""


def is_constant_name(name: str) -> bool:
    """Whether a constant may have this name: upper case, digits and single underscores."""
    return _UPPER.fullmatch(name) is not None


@lru_cache(maxsize=4096)
def is_message_name(name: str) -> bool:
    """Whether a message may have this name: CamelCase; `Sample_` may come before it, `_Request` after."""
    name = name.removeprefix("Sample_")
    for suffix in _RESERVED_SUFFIXES:
        name = name.removesuffix(suffix)
    return _CAMEL.fullmatch(name) is not None


def is_interface_name(name: str, folder: str) -> bool:
    """Whether an interface may have this name; services and actions are judged by their parts' names."""
    suffixes = {"msg": ("",), "srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}
    return all(is_message_name(name + suffix) for suffix in suffixes[folder])


def is_idl_type_name(name: str) -> bool:
    """Whether an interface in an .idl file may have this name, where rosidl has no rule but IDL's own."""
    return _IDL_TYPE.fullmatch(name) is not None and not iskeyword(name)


def is_keyword(name: str) -> bool:
    """Whether Python keeps a name for itself: no package that is imported can have it."""
    return iskeyword(name)


def attribute_name(field: Field) -> str:
    """The public attribute and keyword of a field in Python: `from_` for `from`, which Python keeps."""
    name = field.name
    return f"{name}_" if iskeyword(name) or name in _RESERVED_ATTRIBUTES else name


def default_name(field: Field) -> str:
    """The class attribute that holds the default value of a field: `X__DEFAULT`."""
    return f"{field.name.upper()}__DEFAULT"


def snake_case(name: str) -> str:
    """The snake case in which rosidl names a type's module and file: `PointCloud2` becomes `point_cloud2`."""
    return _CASE_CHANGE.sub(r"\1_\2", _WORD_START.sub(r"\1_\2", name)).lower()
