"""A field of a message by its path: `pose.pose.position`, `poses[0].x`."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Final

from ifgen.command_kit.tool import ToolError, did_you_mean

from ifgen_tools.texts.field_types import FieldType, element_class, field_types, type_name

_STEP: Final = re.compile(r"(?P<name>\w+)(?:\[(?P<index>\d+)\])?")


def selector(cls: type[Any], path: str) -> Callable[[Any], Any]:
    """A function that returns the field of a message of this class.

    The function raises IndexError where a list is too short. Raises ToolError if there is no such field.
    """
    steps: list[tuple[str, int | None]] = []
    inner: type[Any] | None = cls
    for step in filter(None, path.split(".")):
        match = _STEP.fullmatch(step)
        if match is None:
            raise ToolError(f"{path!r} is no path of fields", "write it as pose.position.x, or poses[0].x")
        if inner is None:
            raise ToolError(f"there is nothing inside the field {steps[-1][0]!r}", f"leave out {step!r}")
        types = field_types(inner)
        name, index = match["name"], match["index"]
        if name not in types:
            known = f"its fields are {', '.join(types) or 'none'}"
            raise ToolError(
                f"{type_name(inner)} has no field {name!r}", did_you_mean(name, list(types)) or known
            )
        steps.append((types[name].attribute, None if index is None else int(index)))
        inner = _class_within(inner, name, types[name], index)
    if not steps:
        raise ToolError(
            f"{path!r} names no field", f"{type_name(cls)} has {', '.join(field_types(cls)) or 'none'}"
        )

    def select(message: Any) -> Any:
        for attribute, index in steps:
            message = getattr(message, attribute)
            if index is not None:
                message = message[index]
        return message

    return select


def _class_within(cls: type[Any], name: str, type_: FieldType, index: str | None) -> type[Any] | None:
    """The class that the next step of a path looks into; None if there is none."""
    if index is not None and not type_.is_collection:
        raise ToolError(f"the field {name!r} of {type_name(cls)} is no list", f"leave out the [{index}]")
    if not type_.is_message or (type_.is_collection and index is None):
        return None
    return element_class(cls(), name)
