"""The differences between two versions of interfaces and nodes: a closed sum. Match it exhaustively.

`rules.py` says what an edit breaks, and `words.py` says it to people.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from ifgen.definition.interfaces import Constant, Field, Interface, Message
from ifgen.diagnostics import Span
from ifgen.nodl.model import Endpoint, NodeDescription, Parameter


class Category(StrEnum):
    """The things that an edit may break, the strictest promise first."""

    SOURCE = "source"
    HASH = "hash"
    WIRE = "wire"


@dataclass(frozen=True, slots=True)
class Versions:
    """Both versions of a message, or of a part of a service or an action."""

    old: Message
    new: Message


@dataclass(frozen=True, slots=True)
class FieldAdded:
    """A new field."""

    within: Versions
    field: Field


@dataclass(frozen=True, slots=True)
class FieldRemoved:
    """A field that is gone. `instead` is the field that stands in its place, None at the end."""

    within: Versions
    field: Field
    instead: Field | None


@dataclass(frozen=True, slots=True)
class FieldRenamed:
    """A field with another name: its type and its place are the same."""

    within: Versions
    old: Field
    new: Field


@dataclass(frozen=True, slots=True)
class FieldMoved:
    """A field in another place among the others."""

    within: Versions
    old: Field
    new: Field


@dataclass(frozen=True, slots=True)
class FieldRetyped:
    """A field of another type, which may differ in a bound only.

    `same_layout` is true if each value has the same bytes as before. `same_values` is true if Python code
    that uses the field works as before.
    """

    within: Versions
    old: Field
    new: Field
    same_layout: bool
    same_values: bool


@dataclass(frozen=True, slots=True)
class DefaultChanged:
    """A field with another value in a new message."""

    within: Versions
    old: Field
    new: Field


@dataclass(frozen=True, slots=True)
class MeaningChanged:
    """A field whose comment says another unit, range, frame or invalid value: it `was` so, and is `now`."""

    within: Versions
    old: Field
    new: Field
    aspect: str
    was: str
    now: str


@dataclass(frozen=True, slots=True)
class ConstantAdded:
    """A new constant."""

    within: Versions
    constant: Constant


@dataclass(frozen=True, slots=True)
class ConstantRemoved:
    """A constant that is gone."""

    within: Versions
    constant: Constant


@dataclass(frozen=True, slots=True)
class ConstantRenamed:
    """A constant with another name and the same value."""

    within: Versions
    old: Constant
    new: Constant


@dataclass(frozen=True, slots=True)
class ConstantChanged:
    """A constant with another value in Python."""

    within: Versions
    old: Constant
    new: Constant


@dataclass(frozen=True, slots=True)
class EnumChanged:
    """The enumeration of a field's constants lacks members, although their constants are still there."""

    within: Versions
    field: Field
    name: str
    lost: tuple[Constant, ...]


@dataclass(frozen=True, slots=True)
class InterfaceAdded:
    """A new interface."""

    interface: Interface


@dataclass(frozen=True, slots=True)
class InterfaceRemoved:
    """An interface that is gone."""

    interface: Interface


@dataclass(frozen=True, slots=True)
class InterfaceRenamed:
    """An interface with another name, or in another package, and the same contents."""

    old: Interface
    new: Interface


@dataclass(frozen=True, slots=True)
class PackageRemoved:
    """A package of which nothing is left. `place` is its name in its package.xml, or its first file."""

    name: str
    interfaces: int
    nodes: int
    place: Span | None


MessageEdit: TypeAlias = (
    FieldAdded
    | FieldRemoved
    | FieldRenamed
    | FieldMoved
    | FieldRetyped
    | DefaultChanged
    | MeaningChanged
    | ConstantAdded
    | ConstantRemoved
    | ConstantRenamed
    | ConstantChanged
    | EnumChanged
)
"""A difference within a message."""

InterfaceEdit: TypeAlias = InterfaceAdded | InterfaceRemoved | InterfaceRenamed | PackageRemoved
"""A difference between the interfaces that there are."""


@dataclass(frozen=True, slots=True)
class NodeAdded:
    """A new node."""

    node: NodeDescription


@dataclass(frozen=True, slots=True)
class NodeRemoved:
    """A node that is gone."""

    node: NodeDescription


@dataclass(frozen=True, slots=True)
class NodeRenamed:
    """A node with another name, or in another package, and the same contents."""

    old: NodeDescription
    new: NodeDescription


@dataclass(frozen=True, slots=True)
class NodeClassChanged:
    """A node whose generated class has another name, or is of another kind."""

    old: NodeDescription
    new: NodeDescription


@dataclass(frozen=True, slots=True)
class EndpointAdded:
    """A new endpoint."""

    node: NodeDescription
    endpoint: Endpoint


@dataclass(frozen=True, slots=True)
class EndpointRemoved:
    """An endpoint that is gone."""

    node: NodeDescription
    endpoint: Endpoint


@dataclass(frozen=True, slots=True)
class EndpointRenamed:
    """An endpoint with another name and the same type."""

    node: NodeDescription
    old: Endpoint
    new: Endpoint


@dataclass(frozen=True, slots=True)
class EndpointRetyped:
    """An endpoint of another type."""

    node: NodeDescription
    old: Endpoint
    new: Endpoint


@dataclass(frozen=True, slots=True)
class QosChanged:
    """An endpoint with another QoS profile.

    `mismatch` is the reason why a peer that matched before does not match now; None if all do.
    """

    node: NodeDescription
    old: Endpoint
    new: Endpoint
    mismatch: str | None


@dataclass(frozen=True, slots=True)
class ParameterAdded:
    """A new parameter."""

    node: NodeDescription
    parameter: Parameter


@dataclass(frozen=True, slots=True)
class ParameterRemoved:
    """A parameter that is gone."""

    node: NodeDescription
    parameter: Parameter


@dataclass(frozen=True, slots=True)
class ParameterRenamed:
    """A parameter with another name, and all else the same."""

    node: NodeDescription
    old: Parameter
    new: Parameter


@dataclass(frozen=True, slots=True)
class ParameterRetyped:
    """A parameter of another type; `accepts_all` is true if each value that was accepted still is."""

    node: NodeDescription
    old: Parameter
    new: Parameter
    accepts_all: bool


@dataclass(frozen=True, slots=True)
class ParameterDefaultChanged:
    """A parameter with another default, a new one, or none any more."""

    node: NodeDescription
    old: Parameter
    new: Parameter


@dataclass(frozen=True, slots=True)
class ParameterAccessChanged:
    """A parameter that became read-only, or is so no longer."""

    node: NodeDescription
    old: Parameter
    new: Parameter


@dataclass(frozen=True, slots=True)
class ValidatorsChanged:
    """A parameter with other validators; `accepts_all` is true if each value that was accepted still is."""

    node: NodeDescription
    old: Parameter
    new: Parameter
    accepts_all: bool


NodeEdit: TypeAlias = (
    NodeAdded
    | NodeRemoved
    | NodeRenamed
    | NodeClassChanged
    | EndpointAdded
    | EndpointRemoved
    | EndpointRenamed
    | EndpointRetyped
    | QosChanged
    | ParameterAdded
    | ParameterRemoved
    | ParameterRenamed
    | ParameterRetyped
    | ParameterDefaultChanged
    | ParameterAccessChanged
    | ValidatorsChanged
)
"""A difference between the descriptions of nodes."""

Edit: TypeAlias = MessageEdit | InterfaceEdit | NodeEdit
