"""The kinds of enumeration that upstream's extension module has."""

from __future__ import annotations

from enum import Enum, IntEnum


class ExtensionEnum(IntEnum):
    """An unscoped C enumeration: equal to the integers; prints as `ClassName.MEMBER`."""

    def __str__(self) -> str:
        return f"{type(self).__name__}.{self.name}"


class ScopedEnum(Enum):
    """A scoped C++ enumeration: converts to an integer, but equals none."""

    value: int

    def __int__(self) -> int:
        return self.value

    __index__ = __int__
