"""Sets the fields of a message to values that a user wrote. Fields without a value keep their defaults."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from ifgen.command_kit.tool import ToolError, did_you_mean
from ifgen_runtime import serialize
from ifgen_runtime.convert import yaml_text
from ifgen_runtime.errors import CodecError
from ifgen_runtime.field_types import BASIC_TYPES, Basic, Field, Text, fields_of, type_name
from ifgen_runtime.message import Message

_HEADER = "std_msgs/msg/Header"
_TIME = "builtin_interfaces/msg/Time"

SetStamp = Callable[[Any], None]
"""Puts the time of sending (`builtin_interfaces/msg/Time`) where the user wrote `auto` or `now`."""


def read_yaml(text: str, what: str = "the values") -> Any:
    """A YAML document as a user wrote it. Raises ToolError."""
    try:
        return yaml_text.read(text)
    except yaml_text.YamlError as error:
        raise ToolError(f"{what} are no YAML: {error}", _YAML_HELP) from None


_YAML_HELP = 'write them such as "{linear: {x: 0.5}}", in quotes of the shell'


def set_fields(message: Any, values: Any) -> list[SetStamp]:
    """Put values into the fields of a message.

    `values` is a mapping from names to values, as YAML has it; None is an empty one. `auto` for a Header and
    `now` for a Time stand for the time of sending: for each there is a function that sets it. Raises
    ToolError with the path of the field that is wrong.
    """
    stamps: list[SetStamp] = []
    _fill(message, {} if values is None else values, "", stamps)
    if isinstance(message, Message):  # the setters of a real ROS have checked theirs
        try:
            serialize(message)
        except CodecError as error:
            where = error.path.partition(".")[2]
            raise ToolError(f"the value of {where!r} does not fit: {error.problem}") from None
    return stamps


def _fill(message: Any, values: Any, path: str, stamps: list[SetStamp]) -> None:
    fields = {field.name: field for field in fields_of(type(message))}
    if not isinstance(values, Mapping):
        example = ", ".join(f"{name}: ..." for name in list(fields)[:2])
        advice = _missing_space(values, fields) or f"write {{{example}}}"
        raise _wrong(path, f"expected the fields of {type_name(type(message))}", values, advice)
    for name, value in values.items():
        if name not in fields:
            known = f"its fields are {', '.join(fields) or 'none'}"
            raise ToolError(
                f"{type_name(type(message))} has no field {_join(path, str(name))!r}",
                _missing_space(name, fields) or did_you_mean(str(name), list(fields)) or known,
            )
        where = _join(path, name)
        converted = _converted(message, fields[name], value, where, stamps)
        if converted is not _KEPT:
            try:
                setattr(message, fields[name].attribute, converted)
            except (AssertionError, TypeError, ValueError, OverflowError) as error:
                reason = " ".join(str(error).split())
                raise ToolError(f"the value of {where!r} does not fit: {reason}") from None


def _missing_space(text: Any, fields: Mapping[str, Field]) -> str:
    """Advice for `x:0`, which YAML takes for a text or a name; empty for everything else."""
    name, colon, value = str(text).partition(":")
    return f"write a space after the colon: {{{name}: {value or '...'}}}" if colon and name in fields else ""


_KEPT = object()
"""A value that is in its message already."""


def _converted(message: Any, field: Field, value: Any, where: str, stamps: list[SetStamp]) -> Any:
    if field.is_collection:
        return _list(field, value, where, stamps)
    if isinstance(field.type, Basic | Text):
        return _basic(field.type, value, where)
    inner = getattr(message, field.attribute)
    if field.element == _HEADER and value == "auto":
        stamps.append(lambda stamp: setattr(inner, "stamp", stamp))
    elif field.element == _TIME and value == "now":
        stamps.append(lambda stamp: setattr(message, field.attribute, stamp))
    else:
        _fill(inner, value, where, stamps)
    return _KEPT


def _list(field: Field, values: Any, where: str, stamps: list[SetStamp]) -> Any:
    if isinstance(values, bytes) and field.element in {"uint8", "octet"}:
        values = list(values)
    if not isinstance(values, list | tuple):
        raise _wrong(where, f"expected a list of {field.element}", values)
    if field.size is not None and len(values) != field.size:
        raise ToolError(f"{where!r} has {field.size} elements, and {len(values)} are given")
    if field.maximum is not None and len(values) > field.maximum:
        raise ToolError(f"{where!r} has at most {field.maximum} elements, and {len(values)} are given")
    places = [f"{where}[{index}]" for index in range(len(values))]
    type_ = field.type
    if isinstance(type_, Basic | Text):
        return [_basic(type_, value, place) for value, place in zip(values, places, strict=True)]
    elements = [type_() for _ in values]
    for element, value, place in zip(elements, values, places, strict=True):
        _fill(element, value, place, stamps)
    return elements


def _basic(type_: Basic | Text, value: Any, where: str) -> Any:
    """A value in the Python type of the field."""
    if isinstance(type_, Text):
        text = _text(value, where)
        if type_.maximum is not None and len(text) > type_.maximum:  # a real ROS does not check it
            raise ToolError(f"{where!r} has at most {type_.maximum} characters, and {len(text)} are given")
        return text
    if type_.is_float:
        return _float(value, where)
    match type_.name:
        case "boolean":
            if isinstance(value, bool) or value in (0, 1):
                return bool(value)
            raise _wrong(where, "expected true or false", value)
        case "char":  # of IDL: that of .msg is uint8
            if isinstance(value, str) and len(value) == 1:
                return value
            raise _wrong(where, "expected one character", value)
        case "octet":
            if isinstance(value, str | bytes) and len(value) == 1:
                return value.encode("latin-1", "replace") if isinstance(value, str) else value
            return bytes([_integer(BASIC_TYPES["uint8"], value, where)])
        case _:
            return _integer(type_, value, where)


def _text(value: Any, where: str) -> str:
    if isinstance(value, str):
        if problem := text_problem(value):
            raise ToolError(f"the value of {where!r} does not fit: {problem}")
        return value
    try:
        if isinstance(value, int | float) and not isinstance(value, bool):
            return str(value)  # as ROS does
    except ValueError:  # more digits than Python writes
        pass
    raise _wrong(where, "expected text", value, "put it in quotes within the YAML")


def text_problem(text: str) -> str:
    """The reason why no message can hold a text; empty if one can."""
    if "\0" in text:
        return "a text cannot hold a NUL: strings of ROS end there"
    try:
        text.encode()
    except UnicodeEncodeError as error:
        return f"character {error.start} is half of a surrogate pair, or a byte that is no UTF-8"
    return ""


def _float(value: Any, where: str) -> float:
    if isinstance(value, str | int | float) and not isinstance(value, bool):
        try:
            return float(value)  # YAML 1.1 takes 1e-3 for text
        except (ValueError, OverflowError):
            pass
    raise _wrong(where, "expected a number", value)


def _integer(type_: Basic, value: Any, where: str) -> int:
    lowest, highest = type_.range
    is_number = isinstance(value, int) or (isinstance(value, float) and value.is_integer())
    if not is_number or isinstance(value, bool):
        raise _wrong(where, f"expected an integer ({type_.name})", value)
    if not lowest <= value <= highest:
        raise _wrong(where, f"expected {type_.name}, which is {lowest} to {highest}", value)
    return int(value)


def _wrong(where: str, expected: str, value: Any, help: str = "") -> ToolError:
    place = f"the value of {where!r}" if where else "the message"
    return ToolError(f"{place}: {expected}, got {shown(value)}", help)


def shown(value: Any) -> str:
    """A value as it could be written, in a few words."""
    text = _written(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _written(value: Any) -> str:
    try:
        return json.dumps(value)
    except TypeError:  # YAML knows dates, too
        return str(value)
    except ValueError:  # an integer with more digits than Python writes
        return "a very long number"


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
