"""The types of fields as rosidl_parser.definition has them: what SLOT_TYPES is made of without ROS.

They compare by class and attributes and cannot be hashed, as rosidl's. The underlay's rosidl_parser exports
them.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any, ClassVar

from ifgen_runtime.field_types import Basic, Field, Text, fields_of


class AbstractType:
    """Any type that a field can have."""

    __slots__: ClassVar[tuple[str, ...]] = ()
    __hash__: ClassVar[None] = None  # type: ignore[assignment]  # as rosidl's

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            getattr(self, name) == getattr(other, name)
            for cls in type(self).__mro__[:-1]
            for name in _slots(cls)
        )


def _slots(cls: type[AbstractType]) -> tuple[str, ...]:
    return cls.__dict__["__slots__"]  # type: ignore[no-any-return]


class AbstractNestableType(AbstractType):
    """A type that arrays and sequences can hold."""

    __slots__ = ()


class BasicType(AbstractNestableType):
    """A number, a boolean or an octet."""

    __slots__ = ("typename",)

    def __init__(self, typename: str) -> None:
        self.typename = typename


class NamedType(AbstractNestableType):
    """A type known by a name that is not resolved yet."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name


class NamespacedType(AbstractNestableType):
    """A message type: `NamespacedType(["geometry_msgs", "msg"], "Pose")`."""

    __slots__ = ("name", "namespaces")

    def __init__(self, namespaces: list[str], name: str) -> None:
        self.namespaces = namespaces
        self.name = name

    def namespaced_name(self) -> tuple[str, ...]:
        """The parts of the whole name: `("geometry_msgs", "msg", "Pose")`."""
        return (*self.namespaces, self.name)


class AbstractGenericString(AbstractNestableType):
    """A string of any kind."""

    __slots__ = ()

    def has_maximum_size(self) -> bool:
        """Whether its length has a bound."""
        return "maximum_size" in _slots(type(self))


class AbstractString(AbstractGenericString):
    """A string."""

    __slots__ = ()


class AbstractWString(AbstractGenericString):
    """A wide string."""

    __slots__ = ()


class UnboundedString(AbstractString):
    """`string`."""

    __slots__ = ()


class BoundedString(AbstractString):
    """`string<=N`; the bound counts characters."""

    __slots__ = ("maximum_size",)

    def __init__(self, maximum_size: int) -> None:
        self.maximum_size = maximum_size


class UnboundedWString(AbstractWString):
    """`wstring`."""

    __slots__ = ()


class BoundedWString(AbstractWString):
    """`wstring<=N`; the bound counts characters."""

    __slots__ = ("maximum_size",)

    def __init__(self, maximum_size: int) -> None:
        self.maximum_size = maximum_size


class AbstractNestedType(AbstractType):
    """An array or a sequence of a type."""

    __slots__ = ("value_type",)

    def __init__(self, value_type: Any) -> None:
        assert isinstance(value_type, AbstractNestableType)
        self.value_type = value_type

    def has_maximum_size(self) -> bool:
        """Whether the number of elements has a bound."""
        return bool(_slots(type(self)))


class Array(AbstractNestedType):
    """`T[N]`."""

    __slots__ = ("size",)

    def __init__(self, value_type: Any, size: int) -> None:
        super().__init__(value_type)
        assert size > 0
        self.size = size


class AbstractSequence(AbstractNestedType):
    """A sequence of any kind."""

    __slots__ = ()


class BoundedSequence(AbstractSequence):
    """`T[<=N]`."""

    __slots__ = ("maximum_size",)

    def __init__(self, value_type: Any, maximum_size: int) -> None:
        super().__init__(value_type)
        assert maximum_size > 0
        self.maximum_size = maximum_size


class UnboundedSequence(AbstractSequence):
    """`T[]`."""

    __slots__ = ()


def slot_types_of(message_class: type) -> tuple[Any, ...]:
    """One type object a field, of the rosidl_parser that can be imported (ROS's, the underlay's), or ours."""
    definition = _definition()
    return tuple(_slot_type(field, definition) for field in fields_of(message_class))


def _definition() -> Any:
    try:
        return import_module("rosidl_parser.definition")
    except ImportError:
        return sys.modules[__name__]


def _slot_type(field: Field, definition: Any) -> Any:
    value_type = _value_type(field, definition)
    if field.size is not None:
        return definition.Array(value_type, field.size)
    if not field.is_sequence:
        return value_type
    if field.maximum is None:
        return definition.UnboundedSequence(value_type)
    return definition.BoundedSequence(value_type, field.maximum)


def _value_type(field: Field, definition: Any) -> Any:
    match field.type:
        case Basic(name):
            return definition.BasicType(name)
        case Text(wide, maximum):
            kind = "WString" if wide else "String"
            if maximum is None:
                return getattr(definition, f"Unbounded{kind}")()
            return getattr(definition, f"Bounded{kind}")(maximum)
        case message_class:
            return definition.NamespacedType(message_class.__module__.split(".")[:2], message_class.__name__)
