"""Parameters in YAML as rcl_yaml_param_parser reads them, and as text that it reads again.

rcl does not build a document and look at it. It walks through the events of the parser with a few flags. Its
answers to unusual documents (nested sequences, several documents, maps inside lists) follow from that walk,
so this is the same walk. Aliases are refused, and libyaml refuses more than 1,000 collections in each other.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import yaml

from ifgen_runtime.parameters.parameter_scalars import ParameterVariant, Scalar, Value, read_scalar

__all__ = [
    "PARAMETERS_KEY",
    "Entry",
    "ParameterYamlError",
    "file_text",
    "read_elements",
    "read_file",
    "read_value",
    "value_text",
]

PARAMETERS_KEY: Final = "ros__parameters"
ONLY_LOAD: Final = "#ifgen: "
"""Begins a line that rcl cannot take: a comment for nodes, a parameter for `ifgen param load`."""

_WHY_ONLY_LOAD: Final = "# Nodes cannot read bytes and empty arrays from a file. `ifgen param load` can:"
_MAX_SIZE: Final = 64 * 2**20  # [bytes]; a device has no end
_MAX_DEPTH: Final = 1000  # as libyaml has it; PyYAML's own parser has no limit
_STR: Final = "tag:yaml.org,2002:str"
_TYPE_NAMES: Final[dict[type, str]] = {bool: "bool", int: "integer", float: "double", str: "string"}
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

Entry = dict[str, ParameterVariant]
"""The parameters of one node pattern."""


class ParameterYamlError(ValueError):
    """A text holds no parameters. The message is that of rcl, `reason` is for people."""

    def __init__(self, message: str, reason: str = "") -> None:
        super().__init__(message)
        self.reason = reason or message.strip()


def read_value(text: str, into: ParameterVariant) -> None:
    """Read one scalar or sequence, the right side of `-p name:=...`. Raises ParameterYamlError."""
    values = _Values()
    for event in _events(text, lambda line: "Error parsing an event"):
        match event:
            case yaml.ScalarEvent():
                values.take(event, into)
            case yaml.SequenceStartEvent():
                values.start_sequence()
            case yaml.SequenceEndEvent():
                values.end_sequence()
            case yaml.MappingStartEvent():
                raise ParameterYamlError("Unknown YAML event", "this is a map, which no parameter holds")
            case yaml.AliasEvent():
                raise ParameterYamlError("Unknown YAML event", "aliases are not read")
            case _:
                pass


def value_of(text: str) -> Value:
    """The value of one scalar or sequence; None for an empty sequence. Raises ParameterYamlError."""
    variant = ParameterVariant()
    read_value(text, variant)
    return variant.value()


def read_elements(text: str) -> list[tuple[str, Scalar]]:
    """The elements of a sequence, of any types: their texts and their values. Raises ParameterYamlError."""
    found: list[tuple[str, Scalar]] = []
    is_sequence = False
    for event in _events(text, lambda line: "Error parsing an event"):
        match event:
            case yaml.ScalarEvent() if is_sequence:
                found.append((event.value, _scalar(event)))
            case yaml.SequenceStartEvent() if not is_sequence:
                is_sequence = True
            case yaml.NodeEvent():
                raise ParameterYamlError("Unknown YAML event", "this is not a list of values")
            case _:
                pass
    return found


def read_file(path: str, entry: Callable[[str], Entry], *, everything: bool = False) -> None:
    """Read a parameter file into the entries of node patterns as they are written. Raises ParameterYamlError.

    With `everything` also the lines that are comments for rcl.
    """
    try:
        with Path(path).open("rb") as file:  # or a pipe, as of bash's `<(...)`
            data = file.read(_MAX_SIZE + 1)
    except OSError as error:
        raise ParameterYamlError("Error opening YAML file", f"it cannot be read: {error.strerror}") from None
    if len(data) > _MAX_SIZE:
        raise ParameterYamlError(f"YAML file is larger than {_MAX_SIZE // 2**20} MiB")
    if everything:
        data = re.sub(rb"(?m)^( *)" + re.escape(ONLY_LOAD.encode()), rb"\1", data)
    reader = _FileReader(entry)
    for event in _events(data, lambda line: f"Error parsing a event near line {max(line, 1)}"):
        reader.take(event, _line(event))


def value_text(value: Value | bytes) -> str:
    """A value as `-p name:=...` and `ifgen param set` take it; bytes and `[]` are for `set` only."""
    plain = list(value or ()) if value is None or isinstance(value, bytes) else value
    text: str = yaml.dump(plain, Dumper=_Dumper, default_flow_style=True, width=sys.maxsize)
    return text.removesuffix("\n").removesuffix("\n...")


def file_text(node: str, parameters: Mapping[str, Value | bytes]) -> str:
    """A file with the parameters of a node. rcl reads all except bytes and empty arrays."""
    held = {name: value for name, value in parameters.items() if not is_beyond_files(value)}
    document = {node: {PARAMETERS_KEY: nested(held)}}
    text: str = yaml.dump(document, Dumper=_Dumper, default_flow_style=False, width=sys.maxsize)
    beyond = {name: value for name, value in parameters.items() if name not in held}
    if not beyond:
        return text
    lines = [f"    {ONLY_LOAD}{value_text(name)}: {value_text(value)}" for name, value in beyond.items()]
    if not held:
        text = "".join(f"{ONLY_LOAD}{line}\n" for line in (f"{value_text(node)}:", f"  {PARAMETERS_KEY}:"))
    return "\n".join([text.rstrip("\n"), f"    {_WHY_ONLY_LOAD}", *lines, ""])


def is_beyond_files(value: Value | bytes) -> bool:
    """Whether no parameter file can hold a value: rcl reads no bytes, and `[]` as no value (None)."""
    return isinstance(value, bytes) or value is None or (isinstance(value, list) and not value)


def nested(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters as maps within each other, except for those whose names rule that out, such as `a..b`."""
    tree: dict[str, Any] = {}
    for name, value in parameters.items():
        parts = name.split(".")
        outer = (".".join(parts[:end]) for end in range(1, len(parts)))
        if not all(parts) or len(parts) > _MAX_DEPTH // 2 or any(each in parameters for each in outer):
            tree[name] = value
            continue
        inner = tree
        for part in parts[:-1]:
            inner = inner.setdefault(part, {})
        inner[parts[-1]] = value
    return tree


class _Dumper(yaml.SafeDumper):
    """Puts texts in quotes that rcl or PyYAML takes for something else, such as `y`, `1e5` and `12:30:45`."""

    def ignore_aliases(self, data: Any) -> bool:
        """Write everything where it is used: rcl reads no aliases."""
        return True

    def represent_text(self, text: str) -> yaml.ScalarNode:
        """Write a text on one line."""
        is_plain = isinstance(read_scalar(text), str) and "\n" not in text
        style = '"' if "\n" in text else None if is_plain else "'"
        return self.represent_scalar(_STR, text, style=style)  # pyright: ignore[reportUnknownMemberType]

    def represent_number(self, number: float) -> yaml.ScalarNode:
        """Write a double. C reads subnormal ones in hexadecimal only."""
        if number and abs(number) < sys.float_info.min:
            # A text to PyYAML, so it has no tag.
            return self.represent_scalar(_STR, number.hex())  # pyright: ignore[reportUnknownMemberType]
        return self.represent_float(number)


_Dumper.add_representer(str, _Dumper.represent_text)
_Dumper.add_representer(float, _Dumper.represent_number)


def _events(text: str | bytes, told: Callable[[int], str]) -> Iterator[Any]:
    """The events of a parser, within limits. Raises ParameterYamlError, with rcl's words for the line."""
    line = depth = 0
    try:
        # libyaml refuses a subclass of str.
        for event in yaml.parse(str(text) if isinstance(text, str) else text, Loader=_Loader):
            line = _line(event)
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > _MAX_DEPTH:
                raise ParameterYamlError(told(line), f"line {line}: there are more than {_MAX_DEPTH} levels")
            yield event
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = "" if mark is None else f" at line {mark.line + 1}, column {mark.column + 1}"
        reason = f"it is no YAML: {error.problem or error.context}{place}"
        raise ParameterYamlError(told(line), reason) from None
    except (yaml.YAMLError, UnicodeError) as error:
        reason = " ".join(str(error).split())
        raise ParameterYamlError(told(line), f"it is no YAML: {reason}") from None


def _line(event: Any) -> int:
    line: int = event.start_mark.line
    return line + 1


def _scalar(event: yaml.ScalarEvent) -> Scalar:
    quoted = event.style in ("'", '"')
    if not quoted and not event.value:
        reason = f"line {_line(event)}: there is no value; YAML needs a space after the colon before one"
        raise ParameterYamlError(f"No value at line {_line(event)}", reason)
    if quoted or event.tag == _STR:
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
            raise ParameterYamlError(
                f"Sequence should be of same type. Value type '{_TYPE_NAMES[type(value)]}' do not belong "
                f"at line_num {_line(event)}",
                f"line {_line(event)}: the elements of a list have one type, but {event.value!r} has another",
            )


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

    def __init__(self, entry: Callable[[str], Entry]) -> None:
        self._entry_of = entry
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
                    raise ParameterYamlError(f"Sequences cannot be key at line {line}")
                if not self._below_parameters_key:
                    raise ParameterYamlError(
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
                raise ParameterYamlError(f"Will not support aliasing at line {line}\n")
            case yaml.DocumentStartEvent():
                self._key_follows = True
            case _:
                pass

    def _start_map(self) -> None:
        self._depth += 1
        self._key_follows = True
        directly_below = self._depth == self._node.depth + 2
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
            raise ParameterYamlError(f"No key at line {line}")
        if self._below_parameters_key:
            self._take_parameter_name(key, line)
        elif not key.startswith(PARAMETERS_KEY):
            self._node.push(self._node.below(key))
        elif not self._node.depth:
            raise ParameterYamlError(f"There are no node names before {PARAMETERS_KEY} at line {line}")
        else:
            self._entry = self._entry_of(self._node.text)
            self._parameter = None
            self._below_parameters_key = True

    def _take_parameter_name(self, key: str, line: int) -> None:
        assert self._entry is not None
        if self._new_map:
            if self._parameter is None:
                raise ParameterYamlError(f"Internal error creating param namespace at line {line}")
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
            raise ParameterYamlError(f"Cannot have a value before {PARAMETERS_KEY} at line {line}")
        self._values.take(event, self._entry[self._parameter])
