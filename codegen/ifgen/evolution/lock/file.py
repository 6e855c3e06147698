"""Reads a lock file: its definitions, with their places in it and the hashes that it says they have.

Every mistake is one error with its line. What is returned is as complete as a registry of files: each type
that a field names is in it, and each hash is the hash of its definition.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NoReturn, cast

from ifgen.definition import derive, names
from ifgen.definition.described.values import Value
from ifgen.definition.impossible import check_cycles
from ifgen.definition.interfaces import (
    Action,
    Constant,
    Field,
    Folder,
    Interface,
    Message,
    Registry,
)
from ifgen.definition.literals import BadValue
from ifgen.definition.references import references
from ifgen.definition.type_description import TypeHashes, referenced_types
from ifgen.definition.types import BasicType, FieldType, UnboundedString, UnboundedWString
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shorten, shown_path
from ifgen.evolution.lock.text import END, VERSION, is_type_name, read_type, read_value, written_parts
from ifgen.reading.packages import FOLDERS
from ifgen.reading.storage import read_source

_CONFLICT: Final = ("<<<<<<<", "=======", ">>>>>>>", "|||||||")
_HASH: Final = re.compile(r"RIHS01_[0-9a-f]{64}")
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_DEFINITION: Final = re.compile(r"(?P<type>\S+) (?P<name>[^\s=]+)(?:(?P<sign>[= ])(?P<value>.+))?")
_AGAIN: Final = "run `ifgen lock` again; it does not read this file"
_PARTS: Final = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}


@dataclass(frozen=True, slots=True)
class Lock:
    """The content of a lock file.

    The spans of fields, constants and messages are their places in `source`. `hashes` are those of
    interfaces and of the written parts of services and actions, by type name.
    """

    source: Source
    registry: Registry = field(repr=False)
    hashes: Mapping[str, str] = field(repr=False)


def read(path: Path) -> Lock:
    """Read a lock file. Raises InputError with the first mistake, also if there is no such file."""
    return parse(source(path))


def source(path: Path) -> Source:
    """The text of a lock file. Raises InputError if there is none."""
    if not path.exists():
        message = f"there is no {shown_path(path)}"
        raise InputError([Diagnostic("invalid-lock", message, help="run `ifgen lock`, which writes it")])
    return read_source(path)


def parse(text: Source) -> Lock:
    """Read the text of a lock file. Raises InputError with the first mistake."""
    return _Parser(text).lock()


@dataclass(slots=True)
class _Part:
    """A message being read."""

    name: str
    span: Span
    fields: dict[str, Field] = field(default_factory=dict[str, Field])
    constants: dict[str, Constant] = field(default_factory=dict[str, Constant])

    def message(self, package: str, folder: Folder, source: Source) -> Message:
        fields, constants = tuple(self.fields.values()), tuple(self.constants.values())
        return Message(package, folder, self.name, fields, constants, span=self.span, source=source)


@dataclass(slots=True)
class _Block:
    """An interface being read."""

    package: str
    folder: Folder
    name: str
    span: Span
    parts: list[_Part]


class _Parser:
    """Reads line by line; the first mistake ends it."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._interfaces: dict[str, Interface] = {}
        self._hashes: dict[str, tuple[str, Span]] = {}
        self._block: _Block | None = None

    def lock(self) -> Lock:
        """The whole file."""
        lines = self._lines()
        self._version(lines)
        ended = False
        for start, line in lines:
            if ended:
                self._fail(start, line, "there is text after the end")
            if line == END:
                ended = True
            elif line.startswith("    "):
                self._definition(start + 4, line[4:])
            elif line.startswith("  "):
                self._part(start + 2, line[2:])
            else:
                self._interface(start, line)
        if not ended:
            size = len(self._source.text)
            self._fail(size, "", f"the file is cut off: its last line is not `{END}`")
        self._finish()
        registry = Registry.of_interfaces(self._interfaces.values())
        _check(registry, self._hashes)
        return Lock(self._source, registry, {name: value for name, (value, _) in self._hashes.items()})

    def _lines(self) -> Iterator[tuple[int, str]]:
        """The lines that say something, each with its place."""
        start = 0
        for line in self._source.text.split("\n"):
            if line.startswith(_CONFLICT):
                help = "take either side of the conflict and run `ifgen lock` again"
                self._fail(start, line, "this is the marker of a merge conflict", help)
            if line and not line.startswith("#"):
                yield start, line
            start += len(line) + 1

    def _version(self, lines: Iterator[tuple[int, str]]) -> None:
        start, line = next(lines, (0, ""))
        word, _, version = line.partition(" ")
        if word != "version" or not version.isdecimal():
            self._fail(start, line, f"a lock file begins with `version {VERSION}`")
        if version != str(VERSION):
            message = f"this ifgen reads version {VERSION} of lock files, and this is version {version}"
            self._fail(
                start, line, shorten(message, 100), "use the ifgen that wrote it, or `ifgen lock` again"
            )

    def _interface(self, start: int, line: str) -> None:
        self._finish()
        type_name = line.partition(" ")[0]
        package, folder, name, *rest = (*type_name.split("/"), "", "")
        is_name = (
            not any(rest) and names.is_package_name(package) and folder in FOLDERS and is_type_name(name)
        )
        if not is_name:
            self._fail(start, line, "expected an interface, such as `std_msgs/msg/String RIHS01_...`")
        if type_name in self._hashes:
            self._fail(start, line, f"{type_name} is in the file twice")
        span = self._hash(start, line, type_name)
        parts = [_Part(name, span)] if folder == "msg" else []
        self._block = _Block(package, cast(Folder, folder), name, span, parts)

    def _part(self, start: int, line: str) -> None:
        block = self._block
        expected = _PARTS.get(block.folder, ()) if block else ()
        if block is None or len(block.parts) >= len(expected):
            self._fail(start, line, "expected a field, a constant or the next interface")
        name = f"{block.name}_{expected[len(block.parts)]}"
        if line.partition(" ")[0] != name:
            self._fail(start, line, f"expected the part `{name} RIHS01_...`")
        block.parts.append(_Part(name, self._hash(start, line, f"{block.package}/{block.folder}/{name}")))

    def _hash(self, start: int, line: str, type_name: str) -> Span:
        """Note the hash in a line; the place of the name before it."""
        name, _, value = line.partition(" ")
        if not _HASH.fullmatch(value):
            self._fail(start, line, f"expected the type hash of {type_name}: RIHS01_ and 64 digits")
        span = Span(self._source, start, start + len(name))
        self._hashes[type_name] = value, span
        return span

    def _definition(self, start: int, line: str) -> None:
        match = _DEFINITION.fullmatch(line)
        if self._block is None or not self._block.parts:
            self._fail(start, line, "expected an interface or a part of one before its fields")
        if match is None or not _NAME.fullmatch(match["name"]):
            self._fail(start, line, "expected a field `TYPE NAME`, or a constant `TYPE NAME=VALUE`")
        part, name = self._block.parts[-1], match["name"]
        type_ = read_type(match["type"])
        if type_ is None:
            self._fail(start, match["type"], f"`{shorten(match['type'])}` is not a type")
        if name in part.fields or name in part.constants:
            self._fail(start + match.start("name"), name, f"{part.name} has two definitions of '{name}'")
        value = (
            None
            if match["value"] is None
            else self._value(start + match.start("value"), match["value"], type_)
        )
        place = Span(self._source, start + match.start("name"), start + match.end("name"))
        of_type = Span(self._source, start, start + match.end("type"))
        if match["sign"] != "=":
            part.fields[name] = Field(name, type_, value, span=place, type_span=of_type)
        elif isinstance(type_, BasicType | UnboundedString | UnboundedWString) and not isinstance(
            value, tuple | None
        ):
            part.constants[name] = Constant(name, type_, value, span=place)
        else:
            self._fail(start, match["type"], "a constant has a basic type, or is a string")

    def _value(self, start: int, text: str, type_: FieldType) -> Value:
        try:
            return read_value(text, type_)
        except BadValue as error:
            self._fail(start, text, f"this is no value of its type: {error.message}")

    def _finish(self) -> None:
        """Add the interface that has been read."""
        block, self._block = self._block, None
        if block is None:
            return
        missing = len(_PARTS.get(block.folder, ("",))) - len(block.parts)
        if missing:
            start = block.span.start
            self._fail(
                start, block.name, f"{block.name} has too few parts: {missing} missing", end=block.span.end
            )
        messages = [part.message(block.package, block.folder, self._source) for part in block.parts]
        interface: Interface
        match block.folder:
            case "msg":
                (interface,) = messages
            case "srv":
                interface = derive.service(block.package, "srv", block.name, *messages)
            case "action":
                interface = derive.action(block.package, block.name, *messages)
        self._interfaces[interface.type_name] = interface

    def _fail(
        self, start: int, text: str, message: str, help: str = _AGAIN, *, end: int | None = None
    ) -> NoReturn:
        end = start + len(text) if end is None else end
        raise InputError([_invalid(Span(self._source, start, end), message, help)])


def _invalid(span: Span | None, message: str, help: str = _AGAIN, label: str = "") -> Diagnostic:
    """A mistake in a lock file."""
    return Diagnostic("invalid-lock", message, Label(span, label) if span else None, help=help)


def _check(registry: Registry, hashes: Mapping[str, tuple[str, Span]]) -> None:
    """Raise InputError with the first mistake; `hashes` are those in the file, with their places."""
    messages = {part.type_name: part for interface in registry for part in _messages(interface)}
    missing = next(_missing(registry, messages), None)
    if missing is not None:
        raise InputError([missing])
    for cycle in check_cycles(messages):
        raise InputError([_invalid(cycle.primary.span if cycle.primary else None, cycle.message)])
    _check_hashes(registry, hashes)


def _messages(interface: Interface) -> tuple[Message, ...]:
    return (interface,) if isinstance(interface, Message) else interface.messages


def _missing(registry: Registry, messages: Mapping[str, Message]) -> Iterator[Diagnostic]:
    """The types that are needed, and not in the file."""
    for message in messages.values():
        for user, type_ in references(message):
            if type_.type_name not in messages:
                text = f"{message.type_name} needs {type_.type_name}, which is not in the file"
                yield _invalid(user.type_span or message.span, text)
    for interface in registry:
        for support in derive.ACTION_SUPPORT if isinstance(interface, Action) else ():
            name = "/".join(support)
            if registry.get(name) is None:
                yield _invalid(
                    interface.span, f"{interface.type_name} needs {name}, which is not in the file"
                )


def _check_hashes(registry: Registry, hashes: Mapping[str, tuple[str, Span]]) -> None:
    """Report a hash that does not fit: the one of the smallest type, because others contain that."""
    computed = TypeHashes(registry)
    described = (item for interface in registry for item in (*written_parts(interface), interface))
    wrong = [item for item in described if computed.of(item) != hashes[item.type_name][0]]
    if wrong:
        edited = min(wrong, key=lambda item: len(referenced_types(item, registry)))
        message = f"the hash of {edited.type_name} does not fit its definition here"
        label = f"the definition has the hash {computed.of(edited)}"
        span = hashes[edited.type_name][1]
        raise InputError([_invalid(span, message, f"somebody edited the file; {_AGAIN}", label)])
