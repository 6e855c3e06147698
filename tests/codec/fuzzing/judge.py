"""What codecs do with the same input, in a form that can be compared exactly and fast."""

from __future__ import annotations

import marshal
from array import array
from collections.abc import Callable
from typing import Any, TypeAlias

from ifgen_runtime.field_types import Basic, Field, fields_of

from .graphs import graph, identities

Flat: TypeAlias = Callable[[Any], Any]
ENDLESS = "RecursionError"
"""A message inside itself has no answer: how far each gets, and what the last step makes of the error, differs."""
_flats: dict[type[Any], Flat] = {}


def outcome(function: Callable[..., Any], *arguments: Any) -> tuple[Any, str]:
    """What a call returned, or the class and the words of what it raised."""
    try:
        return function(*arguments), ""
    except KeyboardInterrupt:
        raise
    except RecursionError:
        return None, ENDLESS
    except BaseException as error:
        return None, f"{type(error).__name__}: {error}"


def exact(message: Any) -> bytes:
    """A decoded message down to types and bits: -0.0 is not 0.0, True is not 1, a NaN is that NaN."""
    return marshal.dumps(flat_of(type(message))(message), 2)


def flat_of(cls: type[Any]) -> Flat:
    """The function that makes nested tuples of a complete message of this class."""
    if cls not in _flats:
        names: dict[str, Any] = {"cls": cls, "numbers": _numbers, "texts": _texts}
        parts = [_part(field, names) for field in fields_of(cls)]
        source = f"lambda m: ({id(cls)}, type(m) is cls, {', '.join(parts)})"
        _flats[cls] = eval(source, names)
    return _flats[cls]


def _part(field: Field, names: dict[str, Any]) -> str:
    value = f"m.{field.slot}"
    if isinstance(field.type, Basic):
        return f"numbers({value})" if field.is_collection and field.type.typecode else value
    if not isinstance(field.type, type):
        return f"texts({value})" if field.is_collection else value
    name = f"flat{len(names)}"
    names[name] = flat_of(field.type)
    return (
        f"(type({value}) is list, [{name}(e) for e in {value}])"
        if field.is_collection
        else f"{name}({value})"
    )


def _texts(texts: Any) -> Any:
    return type(texts) is list, *texts


def _numbers(values: Any) -> Any:
    if type(values) is array:
        return values.typecode, values.tobytes()
    return values.dtype.str, values.shape, values.flags.writeable, values.flags.c_contiguous, values.tobytes()


def python_codec(cls: type[Any]) -> tuple[Callable[[Any], bytes], Callable[[bytes], Any]]:
    """The generated functions of a class, whatever codec is attached to it."""
    names = cls.__init__.__globals__
    return names[f"_serialize_{cls.__name__}"], names[f"_deserialize_{cls.__name__}"]


def python_methods(cls: type[Any]) -> tuple[Callable[[Any, Any], Any], Callable[[Any, Any], Any]]:
    """The generated `__eq__` and `__deepcopy__` of a class."""
    names = vars(cls)
    return names.get("__generated_eq__", names["__eq__"]), names.get(
        "__generated_deepcopy__", names["__deepcopy__"]
    )


def copied(copy: Callable[[Any], Any], message: Any) -> Any:
    """What a copy is, and what it shares with the message; or the error."""
    made, error = outcome(copy, message)
    return error.partition(":")[0] if error else graph(made, identities(message))
