"""Fields as numpy arrays: views of their memory, and the helpers that read and fill them."""

from __future__ import annotations

import operator
import sys
from array import array
from numbers import Real
from typing import Any, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ifgen_runtime.codec.encoding import kind_of, shown
from ifgen_runtime.errors import ConversionError

Item = TypeVar("Item", bound=np.generic)

# Variables, because `isinstance(x, np.ndarray)` would be an array of unknown items to type checkers.
_ARRAYS: type[Any] = np.ndarray
_BUFFERS: tuple[type[Any], ...] = (array, bytes, bytearray, memoryview)
_LISTS: type[Any] = list
_REALS: type[Any] = Real

UINT32_MAX = 2**32 - 1
"""The largest size that a field can state, and the most elements that a sequence can have on the wire."""


@overload
def as_array(field: array[int]) -> NDArray[np.integer[Any]]: ...
@overload
def as_array(field: array[float]) -> NDArray[np.floating[Any]]: ...
@overload
def as_array(field: NDArray[Item]) -> NDArray[Item]: ...
@overload
def as_array(field: bytes | bytearray) -> NDArray[np.uint8]: ...
@overload
def as_array(field: memoryview) -> NDArray[Any]: ...


def as_array(field: Any) -> NDArray[Any]:
    """View the numbers of a field, such as `scan.ranges`, without a copy.

    The dtype is the type of the field's items: float32 for `float32[]`. A sequence has shape (n,). A fixed
    array of numbers is a numpy array already, and is returned as it is. Writing to the view writes to the
    field; a view of `bytes` is read-only. An array.array cannot change its length as long as a view of it
    exists (BufferError).

    Raise TypeError for a list. Fields of bool, byte, char, strings and messages hold one, and numpy can only
    copy it.
    """
    values = _view(field)
    if values is None:
        advice = "numpy.array(field) copies it" if isinstance(field, _LISTS) else "pass a field of numbers"
        raise TypeError(f"as_array cannot view {kind_of(field)} without a copy: {advice}")
    return values


def _view(field: Any) -> NDArray[Any] | None:
    if isinstance(field, _BUFFERS):
        return np.asarray(memoryview(field))
    return field if isinstance(field, _ARRAYS) else None


def copied(
    cls: type[Any], name: str, values: NDArray[Any], dtype: np.dtype[Any], typecode: str = "B"
) -> array[Any]:
    """Copy numbers once, for the field of this name: an array.array whose memory holds them as `dtype`."""
    item = bytes(array(typecode).itemsize)
    count = checked_size(cls, name, values.size * dtype.itemsize // len(item))
    data: array[Any] = array(typecode, item) * count
    if values.size and dtype.itemsize:
        if values.dtype == dtype and dtype.names:
            # numpy copies records field by field, which takes 30 times as long.
            dtype = np.dtype((np.void, dtype.itemsize))
            values = values.view(dtype)
        np.ndarray(values.shape, dtype, data)[...] = values
    return data


def new_message(cls: type[Any], like: str, header: object, values: dict[str, Any]) -> Any:
    """Make a message with these values; TypeError if the class does not have the fields.

    `header` is None for the default one. An array.array is stored without a copy.
    """
    message = cls()
    if header is not None:
        values = {"header": header, **values}
    require(message, like, *values)
    for name, value in values.items():
        setattr(message, f"_{name}" if isinstance(value, array) else name, value)
    return message


def require(message: object, like: str, *names: str) -> None:
    """Raise TypeError if a message does not have all of these fields, which one of type `like` has."""
    for name in names:
        if not hasattr(message, name):
            raise TypeError(f"expected {like}, got {kind_of(message)}, which has no field '{name}'")


def name_of(message: object) -> str:
    """The name of a message class, or of a message's class: the start of the path in an error."""
    return (message if isinstance(message, type) else message.__class__).__name__


def octets_in(message: Any, name: str) -> NDArray[np.uint8]:
    """View a field of bytes as one row."""
    return items_in(message, name, np.dtype(np.uint8))


def items_in(message: Any, name: str, dtype: np.dtype[Any]) -> NDArray[Any]:
    """View a field of numbers of this type as one row; ConversionError if the field holds something else.

    A view of received bytes has their byte order.
    """
    value = getattr(message, name)
    values = _view(value)
    if values is None or values.dtype.newbyteorder("=") != dtype or not values.flags.c_contiguous:
        found = kind_of(value) if values is None else f"{kind_of(value)} of {described(values)}"
        raise ConversionError(
            f"{name_of(message)}.{name}", f"expected a contiguous array of {dtype}, got {found}"
        )
    return values.reshape(-1)


def size_in(message: Any, name: str, path: str = "", maximum: int = UINT32_MAX) -> int:
    """The value of an integer field, from 0 to `maximum`. `path` is that of the message, if it is nested."""
    value = getattr(message, name)
    try:
        size = operator.index(value)
    except TypeError:
        size = -1
    if not 0 <= size <= maximum:
        raise ConversionError(
            f"{path or name_of(message)}.{name}", f"expected an integer in [0, {maximum}], got {shown(value)}"
        )
    return size


def number_in(message: Any, name: str, path: str = "", limit: float = sys.float_info.max) -> float:
    """The value of a float field, from -limit to limit. `path` is that of the message, if it is nested."""
    value = getattr(message, name)
    if not isinstance(value, _REALS) or not -limit <= value <= limit:
        raise ConversionError(
            f"{path or name_of(message)}.{name}", f"expected a finite number, got {shown(value)}"
        )
    return float(value)


def checked_size(cls: type[Any], name: str, size: int) -> int:
    """The size itself; ConversionError if the field of this name cannot hold it."""
    if size > UINT32_MAX:
        raise ConversionError(f"{cls.__name__}.{name}", f"expected at most {UINT32_MAX}, got {size}")
    return size


def described(values: NDArray[Any]) -> str:
    """The dtype and the shape of an array, for an error message."""
    return f"{'a structured dtype' if values.dtype.names else values.dtype} and shape {values.shape}"
