"""Lets a class that is put together from private parts look like the one class that it is to users."""

from __future__ import annotations

from types import FunctionType
from typing import TypeVar

AnyClass = TypeVar("AnyClass", bound=type)


def adopt_parts(whole: AnyClass) -> AnyClass:
    """Name the methods of a class's private bases after the class (a decorator), as error texts show them.

    A base is private if its module is: `Node.create_publisher() got an unexpected keyword argument ...`
    shall not name the part of `Node` that has the method.
    """
    for part in whole.__mro__[1:]:
        if "._" in part.__module__:
            for name, member in vars(part).items():
                if isinstance(member, FunctionType):
                    member.__qualname__ = f"{whole.__qualname__}.{name}"
    return whole
