"""The types of fields, as programs that look at SLOT_TYPES import them."""

from ifgen_runtime.rosidl_types import (
    AbstractGenericString,
    AbstractNestableType,
    AbstractNestedType,
    AbstractSequence,
    AbstractString,
    AbstractType,
    AbstractWString,
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    NamedType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)

__all__ = [
    "BASIC_TYPES",
    "BOOLEAN_TYPE",
    "CHARACTER_TYPES",
    "FLOATING_POINT_TYPES",
    "INTEGER_TYPES",
    "OCTET_TYPE",
    "SIGNED_INTEGER_TYPES",
    "UNSIGNED_INTEGER_TYPES",
    "AbstractGenericString",
    "AbstractNestableType",
    "AbstractNestedType",
    "AbstractSequence",
    "AbstractString",
    "AbstractType",
    "AbstractWString",
    "Array",
    "BasicType",
    "BoundedSequence",
    "BoundedString",
    "BoundedWString",
    "NamedType",
    "NamespacedType",
    "UnboundedSequence",
    "UnboundedString",
    "UnboundedWString",
]

BOOLEAN_TYPE = "boolean"
OCTET_TYPE = "octet"
CHARACTER_TYPES = ("char", "wchar")
FLOATING_POINT_TYPES = ("float", "double", "long double")
SIGNED_INTEGER_TYPES = ("short", "long", "long long", "int8", "int16", "int32", "int64")
UNSIGNED_INTEGER_TYPES = (
    "unsigned short",
    "unsigned long",
    "unsigned long long",
    "uint8",
    "uint16",
    "uint32",
    "uint64",
)
INTEGER_TYPES = (*SIGNED_INTEGER_TYPES, *UNSIGNED_INTEGER_TYPES)
BASIC_TYPES = (*INTEGER_TYPES, *FLOATING_POINT_TYPES, *CHARACTER_TYPES, BOOLEAN_TYPE, OCTET_TYPE)
