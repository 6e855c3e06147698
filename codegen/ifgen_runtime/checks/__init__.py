"""Messages that check what they are given: `check_fields=True`, or ROS_PYTHON_CHECK_FIELDS=1.

The checks and the texts of their AssertionErrors are rosidl's. They run in a hidden subclass, made from the
field types when first needed, so that messages without checks pay nothing. An object of it claims to be of
the public class (`__class__`, names, copies, pickles, equality); only `type()` sees the difference.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from typing import Any, TypeAlias

from ifgen_runtime.arrays import array_of
from ifgen_runtime.checks.fields import Setter, element_type, setter
from ifgen_runtime.codec.encoding import type_name
from ifgen_runtime.copying import deepcopy_of
from ifgen_runtime.field_types import Basic, Field, fields_of
from ifgen_runtime.lazy import numpy
from ifgen_runtime.message import DEFAULT, Message, generated_class, note_field

Filler: TypeAlias = tuple[str, Setter, Setter, Callable[[], Any], Callable[[Any], Any] | None]
"""How to fill a field: attribute, setters with and without check, maker of the default value,
conversion before the check."""

_checking: dict[type, tuple[type, tuple[Filler, ...]]] = {}
"""For each public class the hidden subclass and how to fill its fields."""
_set_class: Callable[[Message, type], None] = vars(object)["__class__"].__set__


class InvalidArgumentsError(TypeError, AssertionError):
    """Keywords that a constructor does not know: TypeError as Python's own, AssertionError as rosidl's."""


def initialize(message: Message, arguments: dict[str, Any]) -> None:
    """Finish a constructor that was given `check_fields` or unknown keywords; `arguments` are its locals."""
    if unknown := arguments.pop("_unknown"):
        _initialize_renamed(message, unknown, arguments)
        return
    public = type(message)
    checking_class, fillers = _checking.get(public) or _make_checking_class(public)
    _set_class(message, checking_class)
    for attribute, assign, store, make_default, convert in fillers:
        value = arguments[attribute]
        if value is DEFAULT:
            store(message, make_default())
        elif convert is None:
            assign(message, value)
        else:
            assign(message, _converted(message, attribute, convert, value))


def _converted(message: Message, attribute: str, convert: Callable[[Any], Any], value: Any) -> Any:
    try:
        return convert(value)
    except Exception:
        note_field(message, attribute)
        raise


def _noting(assign: Setter, attribute: str) -> Setter:
    """The same, with a note on errors that do not name the field: those of the value's own methods."""

    def assign_or_note(message: Any, value: Any) -> None:
        try:
            assign(message, value)
        except AssertionError:
            raise
        except Exception:
            note_field(message, attribute)
            raise

    return assign_or_note


def _initialize_renamed(message: Message, unknown: dict[str, Any], arguments: dict[str, Any]) -> None:
    """Accept keywords that are names in the definition (`from` for `from_`), for code that goes by those."""
    if invalid := sorted(unknown.keys() - message.__renamed__.keys()):
        error = InvalidArgumentsError(f"Invalid arguments passed to constructor: {', '.join(invalid)}")
        error.add_note(_meant(type(message), invalid))  # the text is rosidl's, word for word
        raise error
    known = {message.__renamed__[name]: value for name, value in unknown.items()}
    initialize_again: Any = generated_class(type(message)).__init__
    initialize_again(**arguments | known)


def _meant(cls: type[Message], invalid: list[str]) -> str:
    """Advice with similar field names for unknown keywords."""
    from difflib import get_close_matches  # only now

    fields = cls.get_fields_and_field_types()
    found = {name: get_close_matches(name, fields, n=1) for name in invalid}
    meant = ", ".join(f"'{close[0]}' for '{name}'" for name, close in found.items() if close)
    advice = f"did you mean {meant}?" if meant else f"its fields are {', '.join(fields) or 'none'}"
    return f"{type_name(cls)} has no field {' or '.join(map(repr, invalid))}: {advice}"


def switch_checks(message: Message, on: bool) -> None:
    """Check what is assigned to the fields of this message from now on, or no longer."""
    public = message.__class__
    _set_class(message, (_checking.get(public) or _make_checking_class(public))[0] if on else public)


def _make_checking_class(public: Any) -> tuple[type, tuple[Filler, ...]]:
    """Make the hidden subclass of a message class: same layout, same name, all fields checked."""
    namespace: dict[str, Any] = {
        "__slots__": (),
        "__module__": public.__module__,
        "__qualname__": public.__qualname__,
        "__doc__": public.__doc__,
        "__class__": property(lambda _: public),
        # Not what C does: that is for objects of exactly the public class.
        "__deepcopy__": deepcopy_of(public),
        "__copy__": None,  # so it is copied as a pickle would
        "_check_fields": property(lambda _: True, switch_checks),
    }
    fillers: list[Filler] = []
    for field in fields_of(generated_class(public)):
        attribute = field.slot[1:]
        member = getattr(public, field.slot)
        store = member.__set__
        assign = _noting(setter(field, store), attribute)
        namespace[attribute] = property(member.__get__, assign)
        if getattr(public, field.name) is member:  # a name in the definition that is no attribute's
            namespace[field.name] = namespace[attribute]
        fillers.append((attribute, assign, store, _default_maker(field, public), _conversion(field, public)))
    made = type(public)(public.__name__, (public,), namespace)
    made.__slots__ = public.__slots__
    _checking[public] = made, tuple(fillers)
    return _checking[public]


def _default_name(field: Field) -> str:
    return f"{field.name.upper()}__DEFAULT"


def _default_maker(field: Field, owner: type) -> Callable[[], Any]:
    """The maker of default values for a field: the declared one, or zero, empty, or a message of defaults."""
    name = _default_name(field)
    if hasattr(owner, name):
        return lambda: getattr(owner, name)
    match field:
        case Field(is_sequence=True, type=Basic(typecode=str(typecode))) if typecode:
            return lambda: _empty_array(typecode)
        case Field(is_sequence=True):
            return list[Any]
        case Field(size=int(size), type=Basic(typecode=str(typecode), dtype=dtype)) if typecode:
            return lambda: numpy.zeros(size, dtype)
        case Field(size=int(size)):
            return lambda: [_default_element(field) for _ in range(size)]
        case _:
            return lambda: _default_element(field)


def _empty_array(typecode: str) -> array[Any]:
    return array(typecode)


def _default_element(field: Field) -> Any:
    if isinstance(field.type, Basic) and field.type.name == "char":
        return "\0"
    made = element_type(field)()
    return b"\0" if made == b"" else made


def _conversion(field: Field, owner: type) -> Callable[[Any], Any] | None:
    """As rosidl, convert sequences of numbers before they are checked, but not those that have a default."""
    if field.is_sequence and isinstance(field.type, Basic) and not hasattr(owner, _default_name(field)):
        typecode = field.type.typecode
        return (lambda value: array_of(typecode, value)) if typecode else None
    return None
