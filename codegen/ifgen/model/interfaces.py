"""Packages, interfaces and their messages, as generators see them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from ifgen.model.nodes import Node
from ifgen.model.wire import Primitive, Wire

Scalar: TypeAlias = bool | int | float | str
ArrayKind = Literal["fixed", "bounded", "unbounded"]
Kind = Literal["message", "service", "action"]
MessageKind = Literal[
    "message",
    "request",
    "response",
    "event",
    "goal",
    "result",
    "feedback",
    "send_goal_request",
    "send_goal_response",
    "send_goal_event",
    "get_result_request",
    "get_result_response",
    "get_result_event",
    "feedback_message",
]
Base = Literal["bool", "int", "float", "byte", "char", "string", "message"]

_BASES: Mapping[str, Base] = {
    "bool": "bool",
    "byte": "byte",
    "char": "char",
    "float32": "float",
    "float64": "float",
    "string": "string",
    "wstring": "string",
    "message": "message",
}


@dataclass(frozen=True, slots=True)
class Position:
    """A line and a column in the file of an interface, both counted from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Annotation:
    """An annotation of an .idl file: `@name`, `@name(value)`, or `@name(key=value)` with its `parameters`.

    Not those that say what a field or a constant has attributes for: `@default`, `@unit` and comments.
    """

    name: str
    value: Scalar | None
    parameters: Mapping[str, Scalar]


@dataclass(frozen=True, slots=True)
class TypeReference:
    """The name of a message that a field holds: `geometry_msgs/msg/Pose`.

    `interface` is the interface whose file it is in: `Move` for `demo_msgs/srv/Move_Request`.
    """

    type_name: str
    package: str
    folder: str
    name: str
    interface: str
    snake_interface: str

    @property
    def module(self) -> str:
        """The module of its Python class: `geometry_msgs.msg`."""
        return f"{self.package}.{self.folder}"


@dataclass(frozen=True, slots=True)
class Array:
    """An array or a sequence: `size` is the exact number of elements, or the largest one, or None."""

    kind: ArrayKind
    size: int | None


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field or a constant.

    `primitive` is one word for an element, without bounds; `bits` is its size if it is a number, a boolean, a
    byte or a character. `string_bound` is the largest number of characters of a string, None without a bound.
    `message` is set where `primitive` is `message`. `minimum` and `maximum` are the limits of an integer.
    `type_id` is that of REP 2016. `text` is the spelling in a file (`float64[<=3]`, `geometry_msgs/Pose`),
    and `element` that of one element.
    """

    primitive: Primitive
    bits: int | None
    array: Array | None
    string_bound: int | None
    message: TypeReference | None
    minimum: int | None
    maximum: int | None
    type_id: int
    text: str
    element: str

    @property
    def base(self) -> Base:
        """A word for an element: `int` for all integers, `float` for 32 and 64 bits."""
        return _BASES.get(self.primitive, "int")

    @property
    def many(self) -> bool:
        """True for arrays and sequences."""
        return self.array is not None

    @property
    def size(self) -> int | None:
        """The exact number of elements of an array; None for others."""
        return self.array.size if self.array and self.array.kind == "fixed" else None

    @property
    def maximum_size(self) -> int | None:
        """The largest number of elements of a bounded sequence; None for others."""
        return self.array.size if self.array and self.array.kind == "bounded" else None

    @property
    def maximum_length(self) -> int | None:
        """The same as `string_bound`."""
        return self.string_bound


@dataclass(frozen=True, slots=True)
class Value:
    """The value of a constant, of a default, or of an element of one.

    `value` is a boolean, a number or a text; a number for a byte and a character. In JSON, an integer beyond
    2^53 - 1 is its decimal text, and a float that is no number is `nan`, `inf` or `-inf`. `exact` is always
    text: the decimal digits of an integer, the shortest text that reads back as the same float (of 32 or 64
    bits, as the type says), `true` or `false`, the characters of a string. `bits` are those of a float, as
    `0x3f800000`; None for other types.
    """

    value: Scalar
    exact: str
    bits: str | None


@dataclass(frozen=True, slots=True)
class Range:
    """The smallest and the largest value; None where there is no bound."""

    minimum: float | None
    maximum: float | None


@dataclass(frozen=True, slots=True)
class Invalid:
    """The `value` that stands for "no valid data" (the text `nan` for NaN), and `when` it does."""

    value: Scalar
    when: str


@dataclass(frozen=True, slots=True)
class Meaning:
    """The meaning of an element beyond its type, as comments and annotations say it (docs/meaning.md).

    `unit` has its author's spelling. `normal_unit` has one that all authors share, and is None if the unit is
    unknown; `-` says that a number has no unit. `range` bounds each element. `enum` are the names of the
    constants that `[@enum NAME]` names; `closed` is true if they are all the values, and false for a set of
    flags. A `frame` that begins with `@` names a field or a constant. `invalid` is the value for "no valid
    data". `deprecated` is the advice, empty without one. `summary` is all of it but the unit in a few words.
    """

    unit: str | None = None
    normal_unit: str | None = None
    range: Range | None = None
    enum: tuple[str, ...] = ()
    closed: bool = False
    frame: str | None = None
    invalid: Invalid | None = None
    deprecated: str | None = None
    summary: str = ""


@dataclass(frozen=True, slots=True)
class Field:
    """A field.

    `default_value` is the declared default of a single value, `default_elements` that of an array or a
    sequence; None where none is declared. `default` is the spelling of either in a .msg file. `constants` are
    the names of the constants that are its values: `STATUS_OK` and `STATUS_ERROR` for `status`. `names` has a
    name for each language of `ifgen.model.names`, which differs from `name` where that is a reserved word.
    `documentation` is the comment without the tags in it, which `meanings` has. `position` is None for the
    fields of derived messages. `python_default` is the value in a new Python
    object as a literal; None for messages.
    """

    id: str
    name: str
    type: FieldType
    default: str | None
    default_value: Value | None
    default_elements: tuple[Value, ...] | None
    python_default: str | None
    documentation: str
    unit: str | None
    annotations: tuple[Annotation, ...]
    constants: tuple[str, ...]
    names: Mapping[str, str]
    position: Position | None
    meanings: Meaning

    @property
    def attribute(self) -> str:
        """The name in Python."""
        return self.names["python"]

    @property
    def comment(self) -> str:
        """The documentation with its last lines: `Unit: m/s`, and the rest of its meaning in a few words."""
        summary = self.meanings.summary
        last = f"{summary[0].upper()}{summary[1:]}." if summary else ""
        return "\n".join(filter(None, (self.documentation, f"Unit: {self.unit}" if self.unit else "", last)))


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant: its `exact_value`, spelled `value` in a .msg file and `python_value` in Python."""

    id: str
    name: str
    type: FieldType
    value: str
    exact_value: Value
    python_value: str
    documentation: str
    unit: str | None
    annotations: tuple[Annotation, ...]
    names: Mapping[str, str]
    position: Position | None
    meanings: Meaning


@dataclass(frozen=True, slots=True)
class Message:
    """A message: all that has a form on the wire, also parts of services and actions, and derived ones.

    `name` is that of its Python class, `interface` the type name of the interface that it belongs to.
    `type_hash` and `description` (the type description of REP 2016, as ROS writes it to a .json file) are its
    own. `dependencies` are the type names of the messages in its fields, each once. An empty message has no
    `fields`, and is a `placeholder`: one zero byte on the wire, which its description names
    `structure_needs_at_least_one_member`. `generate` is False for what is only needed by others.
    """

    id: str
    type_name: str
    kind: MessageKind
    package: str
    folder: str
    name: str
    snake_name: str
    interface: str
    generate: bool
    type_hash: str
    documentation: str
    dependencies: tuple[str, ...]
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...]
    annotations: tuple[Annotation, ...]
    placeholder: bool
    names: Mapping[str, str]
    position: Position | None
    wire: Wire
    description: Mapping[str, Any]
    meanings: Meaning

    @property
    def role(self) -> MessageKind:
        """The same as `kind`."""
        return self.kind


@dataclass(frozen=True, slots=True)
class Service:
    """A service, of a file or derived from an action, with the type names of its messages."""

    type_name: str
    name: str
    type_hash: str
    request: str
    response: str
    event: str
    description: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Interface:
    """An interface: a .msg, .srv, .action or .idl file.

    `messages` are its parts as they stand in its file: the message itself, request and response, or goal,
    result and feedback. `types` are all its messages, the derived ones too, and `services` its services: one
    for a service, `SendGoal` and `GetResult` for an action. In JSON, both name the messages, which stand in
    the `types` of the document. `uses` are the messages that the fields of its parts hold, each once, without
    its own parts. `file` is the path in its package, `source` the text of the file, and `full_definition` the
    texts of all that it needs as well, in the form of bags: after a line of 80 `=`, `MSG: pkg/Name` and the
    text of that message.
    """

    id: str
    kind: Kind
    package: str
    folder: str
    name: str
    snake_name: str
    type_name: str
    type_hash: str
    generate: bool
    documentation: str
    messages: tuple[Message, ...]
    types: tuple[Message, ...]
    services: tuple[Service, ...]
    uses: tuple[TypeReference, ...]
    file: str
    source: str
    full_definition: str
    names: Mapping[str, str]
    position: Position | None
    description: Mapping[str, Any]
    meanings: Meaning

    @property
    def module(self) -> str:
        """The module of its Python class: `demo_msgs.srv`."""
        return f"{self.package}.{self.folder}"


@dataclass(frozen=True, slots=True)
class Package:
    """A package with its interfaces, sorted by folder and name, and its nodes, sorted by name."""

    name: str
    interfaces: tuple[Interface, ...]
    nodes: tuple[Node, ...]
    generate: bool


@dataclass(frozen=True, slots=True)
class Model:
    """All that a generator gets: packages and types, those that are only needed by others included.

    `types` are all messages, each after those that it needs. `model` is the version of the model: a minor one
    only adds members. `ifgen` is the version of the program.
    """

    model: str
    ifgen: str
    packages: tuple[Package, ...]
    types: tuple[Message, ...]

    def type(self, type_name: str) -> Message:
        """The message of this name. Raises KeyError if there is none."""
        for message in self.types:
            if message.type_name == type_name:
                return message
        raise KeyError(type_name)
