"""Resolved interfaces: every type in a `Registry` exists, every name and literal has been checked.

All values are frozen. Equality ignores spans and sources.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from ifgen.definition.types import BasicType, FieldType, StringType
from ifgen.diagnostics import Diagnostic, Source, Span

Folder = Literal["msg", "srv", "action"]
Plain: TypeAlias = bool | int | float | str
"""The value of a literal."""
Scalar: TypeAlias = Plain | bytes
"""The value of a constant or a default: `bytes` of length 1 for an octet, `str` of length 1 for a char."""


@dataclass(frozen=True, slots=True)
class Annotation:
    """`@name`, `@name(value)` or `@name(name=value, ...)` of an .idl file, for whom it may concern.

    What a field or a constant has attributes for (default value, documentation, unit) is no annotation.
    """

    name: str
    value: Plain | None = None
    parameters: tuple[tuple[str, Plain], ...] = ()


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message. `default_value` is a tuple for arrays and sequences, None where there is none.

    `span` is the place of its name. `type_span` is the place of its type, only for .idl files.
    """

    name: str
    type: FieldType
    default_value: Scalar | tuple[Scalar, ...] | None = None
    documentation: str = ""
    unit: str | None = None
    span: Span | None = field(default=None, compare=False, repr=False)
    type_span: Span | None = field(default=None, compare=False, repr=False)
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant of a message; its type is basic or an unbounded string."""

    name: str
    type: BasicType | StringType
    value: Scalar
    documentation: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    unit: str | None = None
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True)
class Message:
    """A message, or one part of a service or an action: anything that has a form on the wire.

    `fields` is empty for an empty definition. Whoever needs the one-byte placeholder of IDL, type hash and
    wire (`structure_needs_at_least_one_member`) adds it.
    """

    package: str
    folder: Folder
    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()
    documentation: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    source: Source | None = field(default=None, compare=False, repr=False)
    annotations: tuple[Annotation, ...] = ()

    @property
    def type_name(self) -> str:
        """`pkg/msg/Name`."""
        return f"{self.package}/{self.folder}/{self.name}"


@dataclass(frozen=True, slots=True)
class Service:
    """A service and its derived event message. `folder` is `action` for the services inside an action."""

    package: str
    folder: Folder
    name: str
    request: Message
    response: Message
    event: Message
    documentation: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    source: Source | None = field(default=None, compare=False, repr=False)

    @property
    def type_name(self) -> str:
        """`pkg/srv/Name`."""
        return f"{self.package}/{self.folder}/{self.name}"

    @property
    def messages(self) -> tuple[Message, ...]:
        """Request, response and event."""
        return (self.request, self.response, self.event)


@dataclass(frozen=True, slots=True)
class Action:
    """An action, its two derived services and its feedback message."""

    package: str
    name: str
    goal: Message
    result: Message
    feedback: Message
    send_goal: Service
    get_result: Service
    feedback_message: Message
    documentation: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    source: Source | None = field(default=None, compare=False, repr=False)

    @property
    def folder(self) -> Folder:
        """Always `action`."""
        return "action"

    @property
    def type_name(self) -> str:
        """`pkg/action/Name`."""
        return f"{self.package}/action/{self.name}"

    @property
    def messages(self) -> tuple[Message, ...]:
        """Every part that has a form on the wire, ten of them."""
        return (
            self.goal,
            self.result,
            self.feedback,
            *self.send_goal.messages,
            *self.get_result.messages,
            self.feedback_message,
        )


Interface: TypeAlias = Message | Service | Action


@dataclass(frozen=True, slots=True)
class InterfacePackage:
    """The interfaces of one package, sorted by folder and name.

    `complete` is False where only those files were read that somebody else's fields needed.
    """

    name: str
    interfaces: tuple[Interface, ...]
    complete: bool = True


@dataclass(frozen=True, slots=True)
class Registry:
    """A closed set of interfaces: every type that one of them names is in it.

    `requested` names the packages that were asked for; the others are their dependencies. `warnings` are
    about the former: what rosidl would refuse later, or make something surprising of.
    """

    packages: Mapping[str, InterfacePackage]
    requested: tuple[str, ...]
    _interfaces: Mapping[str, Interface] = field(repr=False, compare=False)
    _messages: Mapping[str, Message] = field(repr=False, compare=False)
    warnings: tuple[Diagnostic, ...] = field(default=(), repr=False, compare=False)

    @classmethod
    def of(
        cls,
        packages: Mapping[str, InterfacePackage],
        requested: tuple[str, ...],
        warnings: tuple[Diagnostic, ...] = (),
    ) -> Registry:
        """Index the packages by type name."""
        interfaces = {i.type_name: i for package in packages.values() for i in package.interfaces}
        messages: dict[str, Message] = {}
        for interface in interfaces.values():
            parts = (interface,) if isinstance(interface, Message) else interface.messages
            messages.update((part.type_name, part) for part in parts)
        return cls(packages, requested, interfaces, messages, warnings)

    @classmethod
    def of_interfaces(cls, interfaces: Iterable[Interface], requested: tuple[str, ...] = ()) -> Registry:
        """A registry of interfaces that are not read from packages: of each, only these are known."""
        packages: dict[str, list[Interface]] = {}
        for interface in interfaces:
            packages.setdefault(interface.package, []).append(interface)
        found = {name: InterfacePackage(name, tuple(of), complete=False) for name, of in packages.items()}
        return cls.of(found, requested)

    def __iter__(self) -> Iterator[Interface]:
        return iter(self._interfaces.values())

    def interface(self, type_name: str) -> Interface:
        """The message, service or action of this name (`pkg/msg/Name`); KeyError if there is none."""
        return self._interfaces[type_name]

    def get(self, type_name: str) -> Interface | None:
        """The message, service or action of this name; None if there is none."""
        return self._interfaces.get(type_name)

    def message(self, type_name: str) -> Message:
        """The message of this name, parts of services and actions included; KeyError if there is none."""
        return self._messages[type_name]
