"""Make message objects without running their constructors, for decoders and copies that fill every field."""

from __future__ import annotations

from functools import partial
from types import MemberDescriptorType

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


def creator(cls: type[Any]) -> Callable[[], Any]:
    """A function that makes an instance of a message class whose fields are not set yet."""
    # rosidl's compiled classes keep the switch for checks in a slot; ours have a property.
    if not isinstance(vars(cls).get("_check_fields"), MemberDescriptorType):
        return partial(object.__new__, cls)

    def create() -> Any:
        message: Any = object.__new__(cls)
        message._check_fields = False
        return message

    return create
