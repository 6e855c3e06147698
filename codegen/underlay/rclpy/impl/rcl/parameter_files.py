"""Reads the YAML of parameter files and of `-p name:=value`, event by event as ROS does.

ROS does not build a document and look at it; it walks through the events of the parser with a few flags.
Its answers to unusual documents (nested sequences, several documents, maps inside lists) follow from
that walk, so this is the same walk.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from .lexer import RuleError
from .parameters import Entry, ParameterOverrides, ParameterVariant, Scalar, read_scalar

__all__ = ["read_file", "read_value"]

_MAX_SIZE = 64 * 2**20  # [bytes]; a device has no end
PARAMETERS_KEY = "ros__parameters"
_TYPE_NAMES: dict[type, str] = {bool: "bool", int: "integer", float: "double", str: "string"}
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def _line(event: Any) -> int:
    line: int = event.start_mark.line
    return line + 1


def _scalar(event: yaml.ScalarEvent) -> Scalar:
    quoted = event.style in ("'", '"')
    if not quoted and not event.value:
        raise RuleError(f"No value at line {_line(event)}")
    if quoted or event.tag == "tag:yaml.org,2002:str":
        return str(event.value)
    return read_scalar(event.value)


class _Values:
    """Puts scalars into parameters, one by one or as the elements of a sequence."""

    def __init__(self) -> None:
        self.in_sequence = False
        self._element: type | None = None

    def start_sequence(self) -> None:
        self.in_sequence = True
        self._element = None

    def end_sequence(self) -> None:
        self.in_sequence = False

    def take(self, event: yaml.ScalarEvent, into: ParameterVariant) -> None:
        value = _scalar(event)
        if not self.in_sequence:
            into.set_scalar(value)
        elif self._element is None:
            self._element = type(value)
            into.start_array(value)
        elif self._element is type(value):
            into.append(value)
        else:
            raise RuleError(
                f"Sequence should be of same type. Value type '{_TYPE_NAMES[type(value)]}' do not belong "
                f"at line_num {_line(event)}"
            )


def read_value(text: str, into: ParameterVariant) -> None:
    """Read one scalar or sequence, the right side of `-p name:=...`; raises RuleError."""
    values = _Values()
    try:
        for event in yaml.parse(text, Loader=_Loader):
            match event:
                case yaml.ScalarEvent():
                    values.take(event, into)
                case yaml.SequenceStartEvent():
                    values.start_sequence()
                case yaml.SequenceEndEvent():
                    values.end_sequence()
                case yaml.MappingStartEvent() | yaml.AliasEvent():
                    raise RuleError("Unknown YAML event")
    except yaml.YAMLError:
        raise RuleError("Error parsing an event") from None


def read_file(path: str, overrides: ParameterOverrides) -> None:
    """Read a parameter file into `overrides`; raises RuleError."""
    try:
        with Path(path).open("rb") as file:  # or a pipe, as of bash's `<(...)`
            data = file.read(_MAX_SIZE + 1)
    except OSError:
        raise RuleError("Error opening YAML file") from None
    if len(data) > _MAX_SIZE:
        raise RuleError(f"YAML file is larger than {_MAX_SIZE // 2**20} MiB")
    reader = _FileReader(overrides)
    line = 0
    try:
        for event in _events(data):
            line = _line(event)
            reader.take(event, line)
    except (yaml.YAMLError, UnicodeDecodeError):
        raise RuleError(f"Error parsing a event near line {max(line, 1)}") from None


def _events(data: bytes) -> Iterator[Any]:
    parsed: Iterator[Any] = yaml.parse(data, Loader=_Loader)
    return parsed


class _Path:
    """Names on the way down, as one text: a name with separators in it comes apart on the way up."""

    def __init__(self, separator: str) -> None:
        self.text = ""
        self.depth = 0
        self._separator = separator

    def below(self, name: str) -> str:
        return f"{self.text}{self._separator}{name}" if self.depth else name

    def push(self, text: str) -> None:
        self.text = text
        self.depth += 1

    def pop(self) -> None:
        self.depth -= 1
        self.text = self.text.rpartition(self._separator)[0] if self.depth else ""


def _rename(entry: Entry, old: str, new: str) -> None:
    """Give a parameter another name in its place."""
    renamed = {new if name == old else name: variant for name, variant in entry.items()}
    entry.clear()
    entry.update(renamed)


class _FileReader:
    """The walk: node names until `ros__parameters`, parameter names and values below it."""

    def __init__(self, overrides: ParameterOverrides) -> None:
        self._overrides = overrides
        self._values = _Values()
        self._depth = 0
        self._key_follows = False
        self._new_map = False
        self._below_parameters_key = False
        self._node = _Path("/")
        self._namespace = _Path(".")
        self._entry: Entry | None = None
        self._parameter: str | None = None

    def take(self, event: Any, line: int) -> None:
        """Consume one event of the YAML parser."""
        match event:
            case yaml.ScalarEvent():
                if self._key_follows:
                    self._take_key(event.value, line)
                    self._key_follows = False
                else:
                    self._take_value(event, line)
                    self._key_follows = not self._values.in_sequence
            case yaml.SequenceStartEvent():
                if self._key_follows:
                    raise RuleError(f"Sequences cannot be key at line {line}")
                if not self._below_parameters_key:
                    raise RuleError(
                        f"Sequences can only be values and not keys in params. Error at line {line}\n"
                    )
                self._values.start_sequence()
            case yaml.SequenceEndEvent():
                self._values.end_sequence()
                self._key_follows = True
            case yaml.MappingStartEvent():
                self._start_map()
            case yaml.MappingEndEvent():
                self._end_map()
            case yaml.AliasEvent():
                raise RuleError(f"Will not support aliasing at line {line}\n")
            case yaml.DocumentStartEvent():
                self._key_follows = True

    def _start_map(self) -> None:
        self._depth += 1
        self._key_follows = True
        directly_below = self._depth == self._node.depth + 3
        self._new_map = not (self._below_parameters_key and directly_below)

    def _end_map(self) -> None:
        if not self._below_parameters_key:
            if self._node.depth and self._depth == self._node.depth + 1:
                self._node.pop()
        elif self._namespace.depth:
            self._namespace.pop()
        else:
            self._below_parameters_key = False
        self._depth -= 1

    def _take_key(self, key: str, line: int) -> None:
        if not key:
            raise RuleError(f"No key at line {line}")
        if self._below_parameters_key:
            self._take_parameter_name(key, line)
        elif not key.startswith(PARAMETERS_KEY):
            self._node.push(self._node.below(key))
        elif not self._node.depth:
            raise RuleError(f"There are no node names before {PARAMETERS_KEY} at line {line}")
        else:
            self._entry = self._overrides.entry(self._node.text)
            self._node.pop()
            self._parameter = None
            self._below_parameters_key = True

    def _take_parameter_name(self, key: str, line: int) -> None:
        assert self._entry is not None
        if self._new_map:
            if self._parameter is None:
                raise RuleError(f"Internal error creating param namespace at line {line}")
            # What looked like a parameter is a namespace; its value goes to the first parameter inside.
            outer = self._parameter
            self._namespace.push(outer)
            self._parameter = self._namespace.below(key)
            _rename(self._entry, outer, self._parameter)
            self._new_map = False
            return
        self._parameter = self._namespace.below(key)
        # At the top a second mention adds to the first, in a namespace it starts afresh.
        if self._namespace.depth or self._parameter not in self._entry:
            self._entry[self._parameter] = ParameterVariant()

    def _take_value(self, event: yaml.ScalarEvent, line: int) -> None:
        if not self._below_parameters_key or not self._entry or self._parameter is None:
            raise RuleError(f"Cannot have a value before {PARAMETERS_KEY} at line {line}")
        self._values.take(event, self._entry[self._parameter])
