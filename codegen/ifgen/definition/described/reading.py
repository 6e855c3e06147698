"""From a type description (REP-2016) to definitions: checked first, because anybody may have sent it.

Names go into the text of Python code, and sizes into loops: whatever ROS does not allow is an error here.
What a description does not tell (constants, comments, units) the definitions do not have.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final, cast

from ifgen.definition import names
from ifgen.definition.described.defaults import default_value
from ifgen.definition.described.limits import check_limits
from ifgen.definition.described.types import BadDescription, field_type
from ifgen.definition.escapes import BadValue
from ifgen.definition.impossible import check_cycles
from ifgen.definition.interfaces import (
    Action,
    Field,
    Folder,
    Message,
    Registry,
    Service,
)
from ifgen.definition.references import references
from ifgen.definition.type_description import Described, TypeHashes
from ifgen.definition.types import BasicType, NamespacedType
from ifgen.diagnostics import Diagnostic, InputError, shorten
from ifgen.reading.packages import FOLDERS

_MOST_TYPES: Final = 1_000
_MOST_FIELDS: Final = 20_000
_LONGEST_NAME: Final = 255
_FIELD_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TAKEN: Final = frozenset({"SLOT_TYPES", "get_fields_and_field_types", "mro"})

SERVICE_PARTS: Final = {
    "request_message": "_Request",
    "response_message": "_Response",
    "event_message": "_Event",
}
"""The fields of a service in a description, and how their types are called after it."""
ACTION_PARTS: Final = {
    "goal": "_Goal",
    "result": "_Result",
    "feedback": "_Feedback",
    "send_goal_service": "_SendGoal",
    "get_result_service": "_GetResult",
    "feedback_message": "_FeedbackMessage",
}
"""The same of an action."""


def read(document: object, type_hash: str | None = None) -> tuple[Described, Registry]:
    """The type that a description is about, and a registry with all that it refers to.

    `document` has the keys `type_description` and `referenced_type_descriptions`, as rosidl's .json files and
    `~/get_type_description` have them. Raises InputError with the first mistake: names and types that ROS
    does not allow, types that are missing, cycles, sizes beyond all limits, and a hash that is not
    `type_hash`.
    """
    try:
        reader = _Reader(document)
        described, registry = reader.described(), reader.registry()
        check_limits(reader.messages.values())
    except BadDescription as error:
        raise _invalid(str(error)) from None
    if type_hash is not None and (found := TypeHashes(registry).of(described)) != type_hash:
        message = (
            f"the description of {described.type_name} does not fit its type hash {shorten(type_hash, 80)}"
        )
        raise _invalid(message, f"its fields have the hash {found}: ask again, or ask another node")
    return described, registry


def _invalid(message: str, help: str | None = None) -> InputError:
    return InputError([Diagnostic("invalid-description", message, help=help)])


class _Reader:
    """Reads all types of a description."""

    def __init__(self, document: object) -> None:
        whole = _mapping(document, "a type description")
        main = _item(whole, "type_description", "a type description")
        others = _sequence(_item(whole, "referenced_type_descriptions", "a type description"))
        if len(others) >= _MOST_TYPES:
            raise BadDescription(f"the description has {len(others) + 1} types; the limit is {_MOST_TYPES}")
        self._fields_left = _MOST_FIELDS
        self._raw: dict[str, tuple[Field, ...]] = {}
        self._name = self._individual(main)
        for other in others:
            self._individual(other)
        self.messages: dict[str, Message] = {}
        self._built: dict[str, Described] = {}
        for type_name, fields in self._raw.items():
            if not _parts(type_name, fields):
                self.messages[type_name] = _message(type_name, fields)
        self._check()

    def described(self) -> Described:
        """The type that the description is about."""
        return self._type(self._name)

    def registry(self) -> Registry:
        """All types; the messages of a service or an action belong to that."""
        main = self.described()
        of_main = () if isinstance(main, Message) else main.messages
        parts = {message.type_name for message in of_main}
        others = [
            message for name, message in self.messages.items() if name not in parts and name != self._name
        ]
        return Registry.of_interfaces((main, *others), (main.package,))

    def _individual(self, document: object) -> str:
        item = _mapping(document, "the description of a type")
        type_name = _text(_item(item, "type_name", "the description of a type"))
        _split(type_name)
        if type_name in self._raw:
            raise BadDescription(f"{type_name} is described twice")
        fields = _sequence(_item(item, "fields", type_name))
        self._fields_left -= len(fields)
        if self._fields_left < 0:
            raise BadDescription(f"the description has more than {_MOST_FIELDS} fields")
        self._raw[type_name] = _fields(type_name, fields)
        return type_name

    def _check(self) -> None:
        for message in self.messages.values():
            for field, type_ in references(message):
                if type_.type_name not in self.messages:
                    raise BadDescription(
                        f"the field '{field.name}' of {message.type_name} is a {type_.type_name}, "
                        "which is not described"
                    )
        for cycle in check_cycles(self.messages):
            raise BadDescription(cycle.message)

    def _type(self, type_name: str) -> Described:
        if type_name in self.messages:
            return self.messages[type_name]
        fields = self._raw.get(type_name)
        if fields is None:
            raise BadDescription(f"{self._name} needs {type_name}, which is not described")
        package, folder, name = _split(type_name)
        parts = [self._type(type_name + suffix) for suffix in _parts(type_name, fields).values()]
        of_action = len(parts) == len(ACTION_PARTS)
        kinds = (
            [Message, Message, Message, Service, Service, Message] if of_action else [Message] * len(parts)
        )
        if any(not isinstance(part, kind) for part, kind in zip(parts, kinds, strict=True)):
            raise BadDescription(f"the parts of {type_name} are not those of its kind")
        typed: Any = parts
        return Action(package, name, *typed) if of_action else Service(package, folder, name, *typed)


def _parts(type_name: str, fields: Sequence[Field]) -> Mapping[str, str]:
    """The parts, by the names of their fields, if a type is a service or an action; empty for a message."""
    package, folder, name = _split(type_name)
    for kind in (SERVICE_PARTS, ACTION_PARTS):
        expected = [(part, NamespacedType(package, folder, name + suffix)) for part, suffix in kind.items()]
        if folder != "msg" and [(field.name, field.type) for field in fields] == expected:
            return kind
    return {}


def _message(type_name: str, fields: tuple[Field, ...]) -> Message:
    package, folder, name = _split(type_name)
    if len(fields) == 1 and fields[0].name == names.PLACEHOLDER and fields[0].type == BasicType("uint8"):
        fields = ()
    taken = dict.fromkeys(_TAKEN, "the class itself")
    for field in fields:
        defaults = [names.default_name(field)] if field.default_value is not None else []
        for attribute in (names.attribute_name(field), *defaults):
            if attribute in taken:
                other = taken[attribute]
                raise BadDescription(
                    f"the field '{field.name}' of {type_name} needs the name `{attribute}`, which {other} has"
                )
            taken[attribute] = f"'{field.name}'"
    return Message(package, folder, name, fields)


def _fields(type_name: str, documents: Sequence[object]) -> tuple[Field, ...]:
    fields: dict[str, Field] = {}
    for document in documents:
        item = _mapping(document, f"a field of {type_name}")
        name = _text(_item(item, "name", f"a field of {type_name}"))
        if not _FIELD_NAME.fullmatch(name) or len(name) > _LONGEST_NAME:
            raise BadDescription(f"{shorten(repr(name))} cannot be the name of a field (in {type_name})")
        if name in fields:
            raise BadDescription(f"{type_name} has two fields '{name}'")
        where = f"the field '{name}' of {type_name}"
        type_ = field_type(_mapping(_item(item, "type", where), where), where)
        if isinstance(nested := getattr(type_, "value_type", type_), NamespacedType):
            _split(nested.type_name)
        text = _text(item.get("default_value", ""))
        try:
            value = default_value(text, type_) if text else None
        except BadValue as error:
            message = f"{where} cannot have the default {shorten(text)!r}: {error.message}"
            raise BadDescription(message) from None
        fields[name] = Field(name, type_, value)
    return tuple(fields.values())


def _split(type_name: str) -> tuple[str, Folder, str]:
    """Package, folder and name of a type, if ROS allows them."""
    package, folder, name = (*type_name.split("/", 2), "", "")[:3]
    is_good = len(type_name) <= _LONGEST_NAME and folder in FOLDERS and names.is_idl_type_name(name)
    if not is_good or not names.is_package_name(package) or names.is_keyword(package):
        raise BadDescription(
            f"{shorten(repr(type_name))} is not the name of a type, such as 'std_msgs/msg/String'"
        )
    return package, cast(Folder, folder), name


def _mapping(value: object, what: str) -> Mapping[str, object]:
    if not isinstance(value, Mapping):
        raise BadDescription(f"{what} is not a dictionary, but {_kind(value)}")
    return cast("Mapping[str, object]", value)


def _item(mapping: Mapping[str, object], key: str, where: str) -> object:
    if key not in mapping:
        raise BadDescription(f"{where} has no key '{key}'")
    return mapping[key]


def _sequence(value: object) -> Sequence[object]:
    if not isinstance(value, list | tuple):
        raise BadDescription(f"expected a list, not {_kind(value)}")
    return cast("Sequence[object]", value)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise BadDescription(f"expected a string, not {_kind(value)}")
    return value


def _kind(value: object) -> str:
    return f"a {type(value).__name__}"
