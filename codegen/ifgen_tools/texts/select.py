"""The user's choice of a field by its path (`--field`), and of messages by an expression (`--filter`)."""

from __future__ import annotations

import builtins
import re
from collections.abc import Callable
from typing import Any, Final

import click
from ifgen_runtime.field_types import Field, fields_of, type_name

from ifgen_tools.errors import ToolError, did_you_mean

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
        fields = {field.name: field for field in fields_of(inner)}
        name, index = match["name"], match["index"]
        if name not in fields:
            known = f"its fields are {', '.join(fields) or 'none'}"
            raise ToolError(
                f"{type_name(inner)} has no field {name!r}", did_you_mean(name, list(fields)) or known
            )
        steps.append((fields[name].attribute, None if index is None else int(index)))
        inner = _class_within(inner, fields[name], index)
    if not steps:
        names = ", ".join(field.name for field in fields_of(cls))
        raise ToolError(f"{path!r} names no field", f"{type_name(cls)} has {names or 'none'}")

    def select(message: Any) -> Any:
        for attribute, index in steps:
            message = getattr(message, attribute)
            if index is not None:
                message = message[index]
        return message

    return select


def _class_within(cls: type[Any], field: Field, index: str | None) -> type[Any] | None:
    """The class that the next step of a path looks into; None if there is none."""
    if index is not None and not field.is_collection:
        raise ToolError(
            f"the field {field.name!r} of {type_name(cls)} is no list", f"leave out the [{index}]"
        )
    if field.is_collection and index is None:
        return None
    return field.type if isinstance(field.type, type) else None


def condition(expression: str | None) -> Callable[[Any], bool]:
    """Whether a message, called `m` in the expression, is wanted; without an expression all are.

    Python's own names are there too, as in ROS: it is the user's own code. Raises click.UsageError if it is
    no expression; the function raises ToolError for what the expression raises.
    """
    if not expression:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise click.UsageError(f"--filter {expression!r} is no Python expression: {error}") from None

    def holds(message: Any) -> bool:
        try:
            return bool(eval(code, {"__builtins__": builtins, "m": message}))
        except Exception as error:  # of the user's own code
            reason = f"{type(error).__name__}: {error}"
            raise ToolError(f"--filter {expression!r} failed: {reason}", "the message is called m") from None

    return holds
