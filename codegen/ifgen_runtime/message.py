"""The base of generated message classes.

A generated class keeps its values in slots with public names, so that reading and writing a field costs what
a slot costs; numeric arrays and sequences, which convert what they are given, are properties over private
slots. Either way the private name that rosidl uses (`_x`) reaches the value itself. A message with checks is
an object of a hidden subclass, made by `checks.py`, whose fields are all properties.
"""

from __future__ import annotations

import os
import sys

from ifgen_runtime.copying import copied_fields
from ifgen_runtime.interface import InterfaceMeta, keep_annotations
from ifgen_runtime.lazy import LazyModule

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any, ClassVar, TypeVar

    from ifgen_runtime import checks

    Value = TypeVar("Value")
else:
    checks = LazyModule("ifgen_runtime.checks")


class _Default:
    """The type of `DEFAULT`."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "<default>"


DEFAULT: Any = _Default()
"""Stands for a missing argument whose default has to be made for each call."""


def initialize_checked(message: Message, arguments: dict[str, Any]) -> None:
    """Finish a constructor that was given `check_fields` or unknown keywords; `arguments` are its locals."""
    checks.initialize(message, arguments)


def note_field(message: Message, attribute: str = "") -> None:
    """Say in a note to the error that is handled which field a value was for: `Point.x`.

    It came out of the value itself (its `__iter__`, say) or out of a conversion. Without `attribute` it is
    the first field without a value, as in a constructor. A Problem becomes the error for users.
    """
    from ifgen_runtime.errors import Problem  # only for an error

    error, cls = sys.exception(), generated_class(message.__class__)
    if not attribute:
        attributes = (cls.__renamed__.get(name, name) for name in cls.get_fields_and_field_types())
        attribute = next((name for name in attributes if not hasattr(message, name)), "")
    if isinstance(error, Problem):
        error.__traceback__ = None  # its frames hold the value
        raise error.named(f"{cls.__name__}.{attribute}") from None
    if error is not None and attribute:
        error.add_note(f"{cls.__name__}.{attribute} cannot have this value")


def checks_by_default() -> bool:
    """True if messages check their values by default: `ROS_PYTHON_CHECK_FIELDS` is `1`."""
    return os.environ.get("ROS_PYTHON_CHECK_FIELDS") == "1"


def generated_class(message_class: type[Any]) -> type[Any]:
    """The class as it was generated, for one that may be derived from it. AttributeError for `Message`."""
    for cls in message_class.__mro__:
        if "__type_hash__" in vars(cls):
            return cls
    raise AttributeError(f"{message_class.__name__} is the base of message classes, and has no fields")


def default_of(message_class: type[Value]) -> Callable[[], Value]:
    """The fastest function that makes default messages of a class."""
    if checks_by_default():
        return message_class
    return getattr(message_class, "__default__", message_class)  # rosidl's compiled classes have none


class NoSuchField:
    """The annotation of unknown keywords: no value has this type, so type checkers report all of them."""


class MutableDefault:
    """The `FIELD__DEFAULT` of a mutable default: new through the class, one shared through all objects."""

    def __init__(self, factory: Callable[[], Any]) -> None:
        self.factory = factory

    def __get__(self, message: Message | None, owner: type) -> Any:
        # Through the class, the metaclass's property comes first.
        if not hasattr(self, "_shared"):
            self._shared = self.factory()
        return self._shared


def mutable_default(factory: Callable[[], Value]) -> Value:
    """Declare the `FIELD__DEFAULT` of a field with this default value."""
    return MutableDefault(factory)  # type: ignore[return-value]  # it is what the attribute gives


class _EnumView:
    """An IntEnum of some constants, made when first asked for: that takes as long as importing a module."""

    def __init__(self, members: Mapping[str, int]) -> None:
        self._members = members

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, message: Message | None, owner: type) -> Any:
        from enum import IntEnum  # few programs ask for the classes

        owner = generated_class(owner)
        make_enum: Any = IntEnum
        qualified_name = f"{owner.__qualname__}.{self._name}"
        enum = make_enum(self._name, self._members, module=owner.__module__, qualname=qualified_name)
        setattr(owner, self._name, enum)
        return enum


def enum_view(members: Mapping[str, int]) -> Any:
    """Declare an IntEnum class inside a message class."""
    return _EnumView(members)


class _SlotTypes:
    """`SLOT_TYPES`, made when first asked for: it needs rosidl_parser."""

    def __get__(self, message: Message | None, owner: type[Message]) -> tuple[Any, ...]:
        from ifgen_runtime.rosidl_types import slot_types_of  # with rosidl_parser

        owner = generated_class(owner)
        types = owner.SLOT_TYPES = slot_types_of(owner)
        return types


class _Views:
    """`Image.Views`: for type checkers a class of its own, at run time the class itself."""

    def __get__(self, message: Message | None, owner: type[Message]) -> type[Message]:
        return generated_class(owner)


class MessageMeta(InterfaceMeta):
    """The metaclass of generated messages: type support, read-only constants, rosidl's private names."""

    _CREATE_ROS_MESSAGE: Any = None
    _CONVERT_FROM_PY: Any = None
    _CONVERT_TO_PY: Any = None
    _DESTROY_ROS_MESSAGE: Any = None

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> MessageMeta:
        """Complete a generated class. A class derived from one stays as written."""
        generated = "__type_hash__" in namespace
        if generated:
            _set_first_methods(namespace)
        if generated or not bases:
            keep_annotations(namespace, namespace["__slots__"])
        cls = super().__new__(mcs, name, bases, namespace)
        if not generated and bases:
            _copy_as_derived(cls)
        if generated:
            mcs._interface = cls
            type.__setattr__(cls, "__slots__", _add_private_names(cls, namespace))
            lower_constants = namespace.get("__constants__", ())
            for attribute, value in namespace.items():
                # Only constants and FIELD__DEFAULT are in capitals.
                if attribute.isupper() or attribute in lower_constants:
                    _make_read_only(mcs, attribute, value)
        return cls


def _copy_as_derived(cls: type) -> None:
    """Copy objects of a class that somebody derived by their state, unless it has its own methods for that.

    It may have a `__dict__` and slots that the generated straight-line copy knows nothing of.
    """
    for name, method in (("__deepcopy__", _deepcopy_by_state), ("__copy__", None)):
        owner: Any = next((base for base in cls.__mro__ if name in vars(base)), Message)
        if owner is Message or "__type_hash__" in vars(owner):
            type.__setattr__(cls, name, method)


def _set_first_methods(namespace: dict[str, Any]) -> None:
    """Put methods for the first use of a class in the place of those that C may do, too."""
    for name, generated, first in _FIRST_METHODS:
        if name in namespace:
            namespace[generated] = namespace[name]
            namespace[name] = first


def _first_eq(message: Message, other: object) -> Any:
    return _settled(message).__eq__(message, other)


def _first_deepcopy(message: Message, memo: dict[int, Any]) -> Any:
    return _settled(message).__deepcopy__(message, memo)


def _settled(message: Message) -> Any:
    """The generated class, which now has the methods that it keeps."""
    from ifgen_runtime.codec.choice import attach_methods  # message packages do without

    cls = generated_class(type(message))
    attach_methods(cls)
    return cls


_FIRST_METHODS: tuple[tuple[str, str, Any], ...] = (
    ("__eq__", "__generated_eq__", _first_eq),
    ("__deepcopy__", "__generated_deepcopy__", _first_deepcopy),
)


def _add_private_names(cls: type, namespace: Mapping[str, Any]) -> list[str]:
    members = vars(cls)
    renamed: Mapping[str, str] = namespace.get("__renamed__", {})
    private_names: list[str] = []
    for field in namespace["_fields_and_field_types"]:
        attribute = renamed.get(field, field)
        private = f"_{attribute}"
        if private not in members:
            type.__setattr__(cls, private, members[attribute])
        if attribute != field and not hasattr(cls, field):  # for tools that go by names in the definition
            type.__setattr__(cls, field, members[attribute])
        private_names.append(private)
    return [*private_names, "_check_fields"]


def _make_read_only(metaclass: type, attribute: str, value: Any) -> None:
    is_default = isinstance(value, MutableDefault)
    constant = property(lambda _: value.factory() if is_default else value)
    constant.__set_name__(metaclass, attribute)  # type: ignore[attr-defined]  # typeshed does not know it
    setattr(metaclass, attribute, constant)


def _deepcopy_by_state(message: Message, memo: dict[int, Any]) -> Any:
    from copy import deepcopy  # for classes that users derive

    memo[id(message)] = new = object.__new__(type(message))
    dictionary, slots = message.__reduce_ex__(4)[2]
    for name, value in deepcopy((dictionary or {}) | slots, memo).items():
        object.__setattr__(new, name, value)
    return new


class Message(metaclass=MessageMeta):
    """The base of message classes: what rosidl's message classes have beside their fields."""

    __slots__ = ()

    __type_hash__: ClassVar[str]
    __renamed__: ClassVar[dict[str, str]] = {}
    """Fields whose attribute is called otherwise, since their name is a Python keyword or needed here."""
    __constants__: ClassVar[tuple[str, ...]] = ()
    """Constants whose names are not in capitals."""

    _fields_and_field_types: ClassVar[dict[str, str]]
    SLOT_TYPES: ClassVar[tuple[Any, ...]] = _SlotTypes()  # type: ignore[assignment]  # gives it

    if TYPE_CHECKING:

        def __deepcopy__(self, memo: dict[int, Any]) -> Any:
            """A copy that shares nothing with this message; sharing within it is kept."""
    else:
        Views = _Views()

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Field names and types, as rosidl spells them: `{"position": "sequence<double>"}`."""
        return dict(cls._fields_and_field_types)

    def __copy__(self) -> Any:
        """A copy that shares the values of the fields. As `__serialize__`, for the first use of a class."""
        return _settled(self).__copy__(self)

    def __generated_copy__(self) -> Any:
        return copied_fields(self)

    def __serialize__(self) -> bytes:
        """The CDR form. This is for the first use of a class, which then gets functions of its own."""
        from ifgen_runtime.codec.choice import attached  # message packages do without

        return attached(generated_class(type(self)))[0](self)

    @classmethod
    def __deserialize__(cls, data: bytes) -> Any:
        """The message in these bytes. As `__serialize__`, this is for the first use of a class."""
        from ifgen_runtime.codec.choice import attached  # message packages do without

        return attached(generated_class(cls))[1](data)

    def _repr_html_(self) -> str:
        """The message as notebooks show it: a table of its fields."""
        from ifgen_runtime.convert.notebook import html_of  # only notebooks ask

        return html_of(self)

    @property
    def _check_fields(self) -> bool:
        """Whether values are checked when they are assigned; can be changed."""
        return False

    @_check_fields.setter
    def _check_fields(self, value: object) -> None:
        checks.switch_checks(self, bool(value))

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickle as rosidl's classes do, whose pickles can be read by ours and ours by theirs."""
        reduced: Any = super().__reduce_ex__(max(protocol, 2))  # older ones cannot hold slots
        function, (_, *arguments), *state = reduced
        # An object with checks is of a hidden class, but claims the public one.
        return (function, (self.__class__, *arguments), *state)
