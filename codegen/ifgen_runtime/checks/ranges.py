"""Values outside the ranges that comments declare: `IFGEN_CHECK_FIELDS=1` warns of them.

Each publisher and each subscription looks at its messages. It warns at most once a second, because a sensor
that is wrong once is wrong all the time. Without the variable nothing looks, and messages cost nothing more.
"""

from __future__ import annotations

import math
import os
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from ifgen_runtime.field_types import fields_of, type_name
from ifgen_runtime.meaning import Invalid, Range, meanings
from ifgen_runtime.message import Message, generated_class

VARIABLE: Final = "IFGEN_CHECK_FIELDS"
"""The environment variable."""

_PERIOD: Final = 1.0
"""Seconds between two warnings of an endpoint, at least."""

Look: TypeAlias = Callable[[Any], None]
"""Looks at a message, and warns."""


@dataclass(frozen=True, slots=True)
class _Field:
    """A field with a range, or one of messages whose fields have some, with the class that it is of."""

    attribute: str
    is_many: bool
    owner: type[Message]
    range: Range | None = None
    invalid: Invalid | None = None
    nested: tuple[_Field, ...] = ()


@dataclass(frozen=True, slots=True)
class _Violation:
    """A value outside its range, and the way to it from the message: `wheels[2].speed`."""

    path: str
    value: float
    field: _Field


def look_at(cls: type[Any], topic: str, verb: str, warn: Callable[[str], object]) -> Look | None:
    """The function that looks at the messages of an endpoint; None if nothing is to be looked at.

    `verb` is `published` or `received`, and `warn` says a line of text.
    """
    if not os.environ.get(VARIABLE, "").strip("0") or not issubclass(cls, Message):
        return None
    fields = _checked(generated_class(cls))
    return _Looking(fields, f"topic '{topic}': {verb} {type_name(cls)}", warn).look if fields else None


class _Looking:
    """The state of one endpoint: when it has warned last, and how often it has not since."""

    def __init__(self, fields: tuple[_Field, ...], beginning: str, warn: Callable[[str], object]) -> None:
        self._fields = fields
        self._beginning = beginning
        self._warn = warn
        self._due = -math.inf
        self._kept_back = 0

    def look(self, message: Any) -> None:
        """Warn of the first value outside its range, if the last warning was long enough ago."""
        found = next(_violations(message, self._fields), None)
        if found is None:
            return
        now = time.monotonic()
        if now < self._due:
            self._kept_back += 1
            return
        more = f"; {self._kept_back} more since the last warning" if self._kept_back else ""
        self._due, self._kept_back = now + _PERIOD, 0
        assert found.field.range is not None
        range_ = found.field.range
        low, high = range_.minimum, range_.maximum
        bounds = (
            f"above {high}" if low is None else f"below {low}" if high is None else f"outside {low} to {high}"
        )
        place = _place(found.field.owner, found.field.attribute)
        self._warn(f"{self._beginning} with {found.path} = {found.value}, {bounds} ({place}){more}")


def _checked(cls: type[Message]) -> tuple[_Field, ...]:
    """The fields of a class with ranges, and those of messages that have such fields."""
    return tuple(_fields(cls))


def _fields(cls: type[Message]) -> Iterator[_Field]:
    said = meanings(cls)
    for field in fields_of(cls):
        attribute = field.slot[1:]
        is_many = field.is_sequence or field.size is not None
        range_ = next((each for each in said.get(attribute, ()) if isinstance(each, Range)), None)
        invalid = next((each for each in said.get(attribute, ()) if isinstance(each, Invalid)), None)
        if isinstance(field.type, type):
            nested = _checked(generated_class(field.type)) if issubclass(field.type, Message) else ()
            if nested:
                yield _Field(attribute, is_many, cls, nested=nested)
        elif range_ is not None:
            yield _Field(attribute, is_many, cls, range_, invalid)


def _violations(message: Any, fields: tuple[_Field, ...], before: str = "") -> Iterator[_Violation]:
    for field in fields:
        held = getattr(message, field.attribute)
        for index, value in enumerate(held) if field.is_many else ((None, held),):
            path = f"{before}{field.attribute}" + ("" if index is None else f"[{index}]")
            if field.nested:
                yield from _violations(value, field.nested, f"{path}.")
            elif field.range is not None and _is_outside(value, field.range, field.invalid):
                yield _Violation(path, value, field)


def _is_outside(value: Any, range_: Range, invalid: Invalid | None) -> bool:
    """Whether a number is outside; NaN is not, as it stands for nothing."""
    low, high = range_.minimum, range_.maximum
    if not ((low is not None and value < low) or (high is not None and value > high)):
        return False
    return invalid is None or not invalid.is_value(value)


def _place(cls: type[Message], attribute: str) -> str:
    """The file and the line of a field: `demo_msgs/msg/Drive.msg:5`; without the line where it is unknown."""
    module: dict[str, Any] = getattr(cls.__init__, "__globals__", {})
    package, folder, name = type_name(cls).split("/")
    interface = name if folder == "msg" else name.partition("_")[0]
    file = f"{package}/{folder}/{interface}.{module.get('__encoding__') or folder}"
    lines = str(module.get("__source__", "")).splitlines()
    pattern = re.compile(rf"[^#\n]*\b{re.escape(attribute)}\b")
    return next((f"{file}:{number}" for number, line in enumerate(lines, 1) if pattern.match(line)), file)
