"""Messages as plain dictionaries, YAML and JSON: for people, configuration files and tools.

Fields appear under their names in the definition, nested messages as dictionaries, arrays and sequences as
lists. An octet is an integer, as in `uint8`, so a blob is a list of integers.
"""

from __future__ import annotations

import json
import math
import re
from array import array
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NoReturn, TypeVar

from ifgen_runtime.arrays import array_of, is_array
from ifgen_runtime.codec.encoding import (
    basic_wire,
    is_collection,
    is_message,
    kind_of,
    listed,
    shown,
    text_wire,
    type_name,
)
from ifgen_runtime.errors import ConversionError, Problem
from ifgen_runtime.field_types import Basic, Field, Text, fields_of
from ifgen_runtime.lazy import numpy

MessageT = TypeVar("MessageT")

_NOT_FINITE = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}
_UNSAFE_IN_YAML = re.compile("[\x85\u2028\u2029\ufeff]")
# PyYAML follows YAML 1.1, where an exponent needs a dot and a sign: `1e-3` arrives as a string.
_EXPONENT = re.compile(r"[-+]?\d+(\.\d*)?[eE][-+]?\d+")


def to_dict(message: Any) -> dict[str, Any]:
    """The message as nested dictionaries of str, int, float, bool and list.

    Raises ConversionError, with the path of the field, where a value is not what the field can hold.
    """
    cls = message.__class__
    try:
        fields_of(cls)
    except TypeError:
        raise ConversionError(cls.__name__, f"expected a message, got {kind_of(message)}") from None
    try:
        return _plain_message(message, cls)
    except Problem as problem:
        raise ConversionError(cls.__name__ + problem.place, problem.text) from problem.__cause__


def from_dict(cls: type[MessageT], mapping: Mapping[str, Any]) -> MessageT:
    """A message from nested dictionaries; fields that are not mentioned keep their default values.

    Integers are accepted for floats, and so are the strings that `to_json` writes for what JSON cannot hold;
    an octet may also be `bytes` of length 1 or, as `ros2 topic echo` prints it, a string of one character.
    Raises ConversionError, with the path of the field, for unknown fields, wrong types, values out of range,
    and lengths over a bound, and TypeError if `cls` is no class.
    """
    _expect_class(cls, "from_dict", "mapping")
    try:
        message: MessageT = _message(mapping, cls)
    except Problem as problem:
        raise ConversionError(cls.__name__ + problem.place, problem.text) from problem.__cause__
    return message


def to_yaml(message: Any) -> str:
    """The message as YAML, one field a line, in the order of the definition."""
    import yaml  # messages do without

    class Dumper(yaml.SafeDumper):
        """Quotes texts that PyYAML would write unchanged, but then read as a line break or not at all."""

        def represent_str(self, data: str) -> yaml.ScalarNode:
            style = '"' if _UNSAFE_IN_YAML.search(data) else None
            # PyYAML says nothing about its value's type.
            return self.represent_scalar("tag:yaml.org,2002:str", data, style)  # pyright: ignore[reportUnknownMemberType]

    Dumper.add_representer(str, Dumper.represent_str)
    text: str = yaml.dump(to_dict(message), Dumper=Dumper, sort_keys=False, allow_unicode=True)
    return text


def from_yaml(cls: type[MessageT], text: str | bytes) -> MessageT:
    """A message from YAML, as `from_dict`; an empty document is a message of default values.

    ConversionError too for what is no YAML, and for what is larger than `yaml_text` reads.
    """
    from ifgen_runtime.convert import yaml_text  # with PyYAML, which messages do without

    _expect_class(cls, "from_yaml", "text")
    try:
        document = yaml_text.read(text)
    except yaml_text.YamlError as failure:
        _refuse_text(cls, "YAML", failure)
    return from_dict(cls, {} if document is None else document)


def to_json(message: Any, *, indent: int | None = None) -> str:
    """The message as JSON. Floats that JSON cannot hold become "NaN", "Infinity" and "-Infinity"."""
    return json.dumps(_json_values(to_dict(message)), indent=indent, ensure_ascii=False, allow_nan=False)


def from_json(cls: type[MessageT], text: str | bytes) -> MessageT:
    """A message from JSON, as `from_dict`."""
    _expect_class(cls, "from_json", "text")
    try:
        document = json.loads(text)
    except (ValueError, RecursionError, TypeError) as failure:
        _refuse_text(cls, "JSON", failure)
    return from_dict(cls, document)


def _expect_class(cls: object, function: str, other: str) -> None:
    """Refuse arguments in the order of `deserialize`."""
    if not isinstance(cls, type):
        raise TypeError(f"{function}() takes the class first, and the {other} second")


def _refuse_text(cls: type[Any], language: str, failure: Exception) -> NoReturn:
    reason = " ".join(str(failure).split())
    raise ConversionError(cls.__name__, f"not {language}: {reason}") from None


def _json_values(value: Any) -> Any:
    if value.__class__ is dict:
        return {key: _json_values(item) for key, item in value.items()}
    if value.__class__ is list:
        return [_json_values(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value


def _refuse(failure: Exception, place: str = "") -> NoReturn:
    """Raise a problem with a step of its path, or one for what a value's own `__iter__` or such raised."""
    if isinstance(failure, Problem):
        raise failure.at(place) from failure.__cause__
    raise Problem(f"cannot be read: {type(failure).__name__}: {failure}").at(place) from failure


def _key(name: object) -> str:
    """A key of any type, for the path in an error."""
    return name if isinstance(name, str) and name.isprintable() and len(name) <= 40 else shown(name)


# From a message


def _plain_message(message: Any, cls: type[Any]) -> dict[str, Any]:
    return {field.name: _plain_field(message, field) for field in fields_of(cls)}


def _plain_field(message: Any, field: Field) -> Any:
    try:
        value: Any = getattr(message, field.slot, None)
        if not field.is_collection:
            return _plain_value(value, field.type)
        if isinstance(field.type, Basic) and field.type.typecode and hasattr(value, "tolist"):
            return (value.ravel() if hasattr(value, "ravel") else value).tolist()
        return list(_plain_elements(listed(value, field.type), field))
    except Exception as failure:
        _refuse(failure, f".{field.name}")


def _plain_elements(values: Any, field: Field) -> Iterator[Any]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise Problem(f"expected a list, got {kind_of(values)}")
    for index, value in enumerate(values):
        try:
            yield _plain_value(value, field.type)
        except Exception as failure:
            _refuse(failure, f"[{index}]")


def _plain_value(value: Any, type_: Basic | Text | type[Any]) -> Any:
    if isinstance(type_, Text):
        text_wire(value, type_)
        return str(value)
    if isinstance(type_, Basic):
        wire = basic_wire(value, type_)
        if type_.name == "octet":
            return wire[0]
        if type_.name == "char":
            return str(value)
        return value if isinstance(value, bool | float) else int(value)
    if not is_message(value, type_):
        raise Problem(f"expected {type_name(type_)}, got {kind_of(value)}")
    return _plain_message(value, type_)


# To a message


def _message(mapping: Any, cls: type[Any]) -> Any:
    if is_message(mapping, cls):
        return mapping
    if not _is_mapping(mapping):
        raise Problem(f"expected a mapping, got {kind_of(mapping)}")
    fields = {field.name: field for field in fields_of(cls)}
    message = cls()
    try:
        items = list(mapping.items())
    except Exception as failure:
        _refuse(failure)
    for name, value in items:
        field = fields.get(name)
        if field is None:
            known = ", ".join(fields) or "none"
            raise Problem(f"no such field; its fields are: {known}").at(f".{_key(name)}")
        convert = _collection if field.is_collection else _value
        try:
            setattr(message, field.slot, convert(value, field))
        except Exception as failure:
            _refuse(failure, f".{name}")
    return message


def _is_mapping(value: object) -> bool:
    return isinstance(value, Mapping)


def _collection(value: Any, field: Field) -> Any:
    if not isinstance(field.type, Basic) or not field.type.typecode:
        return list(_elements(_listed(value, field), field))
    if is_array(value):
        numbers = array_of(field.type.typecode, value)
        _check_count(len(numbers), field)
    else:
        numbers = _numbers(_listed(value, field), field, field.type)
    return numbers if field.is_sequence else numpy.array(numbers)


def _listed(value: Any, field: Field) -> Sequence[Any]:
    values: Sequence[Any] = listed(value, field.type)
    if not is_collection(values):
        raise Problem(f"expected a list, got {kind_of(value)}")
    _check_count(len(values), field)
    return values


def _check_count(count: int, field: Field) -> None:
    if field.size is not None and count != field.size:
        raise Problem(f"expected {field.size} elements, got {count}")
    if field.maximum is not None and count > field.maximum:
        raise Problem(f"expected at most {field.maximum} elements, got {count}")


def _elements(values: Sequence[Any], field: Field) -> Iterator[Any]:
    for index, value in enumerate(values):
        try:
            yield _value(value, field)
        except Exception as failure:
            _refuse(failure, f"[{index}]")


def _numbers(values: Sequence[Any], field: Field, type_: Basic) -> array[Any]:
    # A blob is a million integers. `array` checks their range, but takes a float32 too large for infinity and
    # bytes for what is in memory.
    is_memory = isinstance(values, bytes | bytearray) and type_.typecode != "B"
    if {int}.issuperset(map(type, values)) and type_.typecode != "f" and not is_memory:
        with suppress(OverflowError):
            return array(type_.typecode, values)
    return array(type_.typecode, _elements(values, field))


def _value(value: Any, field: Field) -> Any:
    if isinstance(field.type, Text):
        text_wire(value, field.type)
        return value
    if not isinstance(field.type, Basic):
        return _message(value, field.type)
    value = _basic_value(value, field.type)
    basic_wire(value, field.type)
    return value


def _basic_value(value: Any, type_: Basic) -> Any:
    """The value in the Python type of the field, where that loses nothing."""
    if type_.name == "octet":
        return _octet(value)
    if type_.is_float:
        if isinstance(value, str):
            return _NOT_FINITE.get(value, float(value) if _EXPONENT.fullmatch(value) else value)
        if isinstance(value, int) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                raise Problem(f"{kind_of(value)} does not fit into a float64") from None
    elif type_.name not in ("boolean", "char") and isinstance(value, bool):
        raise Problem("expected int, got bool")
    return value


def _octet(value: Any) -> Any:
    if isinstance(value, str) and len(value) == 1 and ord(value) < 256:
        return bytes([ord(value)])
    if isinstance(value, int) and not isinstance(value, bool):
        if not 0 <= value <= 255:
            raise Problem(f"expected an integer in [0, 255], got {shown(value)}")
        return bytes([value])
    return value
