"""Sequences of numbers that stay in the bytes that their message came in: `deserialize(..., views=True)`.

A message with views is an ordinary object of its class. Its numeric sequences are numpy arrays instead of
array.array, whatever their size; all its other fields are as always. The arrays keep the bytes alive.
"""

from __future__ import annotations

from collections.abc import Callable
from sys import byteorder
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ifgen_runtime.codec.choice import attached, chosen, decoder_in_python
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.field_types import BASIC_TYPES, Basic, fields_of

Int8Array: TypeAlias = NDArray[np.int8]
UInt8Array: TypeAlias = NDArray[np.uint8]
Int16Array: TypeAlias = NDArray[np.int16]
UInt16Array: TypeAlias = NDArray[np.uint16]
Int32Array: TypeAlias = NDArray[np.int32]
UInt32Array: TypeAlias = NDArray[np.uint32]
Int64Array: TypeAlias = NDArray[np.int64]
UInt64Array: TypeAlias = NDArray[np.uint64]
Float32Array: TypeAlias = NDArray[np.float32]
Float64Array: TypeAlias = NDArray[np.float64]

_DTYPES = {basic.typecode: np.dtype(basic.dtype) for basic in BASIC_TYPES.values() if basic.dtype}
_TYPECODES = {dtype: typecode for typecode, dtype in _DTYPES.items()}


def _writing(name: str) -> Any:
    """The method of ndarray that writes to the array, which first has to own its memory."""
    method = getattr(np.ndarray, name)

    def write(self: SequenceView, *arguments: Any, **options: Any) -> Any:
        self.make_writable()
        return method(self, *arguments, **options)

    write.__name__ = name
    write.__doc__ = method.__doc__
    return write


class SequenceView(np.ndarray[Any, np.dtype[Any]]):
    """A numeric sequence in received bytes, of shape (n,): read-only until it is written to.

    Item assignment, in-place operators and in-place methods copy the numbers first, once. So
    `image.data[0] = 1` and `image.data += 1` change the message, and never the received bytes.

    Arrays that are derived from it, such as slices and reshapes, are read-only views of the bytes. Writing to
    them is numpy's own ValueError, because the message would not see it. Results of calculations are plain
    arrays. A copy or a pickle owns its memory. The dtype has the byte order of the bytes.
    """

    __slots__ = ("_received",)

    @property
    def typecode(self) -> str:
        """The type code of an array.array of the same memory, for the codec; empty if there is none."""
        return _TYPECODES.get(self.dtype, "") if self.ndim == 1 and self.flags.c_contiguous else ""

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Leave results of calculations plain arrays and scalars."""
        if array is self:
            return array
        result = np.asarray(array)
        return result if result.ndim else result[()]

    def make_writable(self) -> None:
        """Copy the numbers out of the received bytes, if they are still there. What writes does this first.

        Arrays that were derived before keep showing the received bytes, so it keeps these alive.
        """
        received = self.base  # of a derived array, this is the array that it is derived from
        if isinstance(received, bytes) and not self.flags.writeable:
            numbers = np.array(self)
            self._received = received
            empty: Any = (1, (0,), self.dtype, False, b"")  # the types of numpy know no plain False here
            self.__setstate__(empty)
            self.resize(numbers.shape, refcheck=False)
            np.copyto(self, numbers)

    __setitem__ = _writing("__setitem__")
    __iadd__ = _writing("__iadd__")
    __isub__ = _writing("__isub__")
    __imul__ = _writing("__imul__")
    __itruediv__ = _writing("__itruediv__")
    __ifloordiv__ = _writing("__ifloordiv__")
    __imod__ = _writing("__imod__")
    __ipow__ = _writing("__ipow__")
    __ilshift__ = _writing("__ilshift__")
    __irshift__ = _writing("__irshift__")
    __iand__ = _writing("__iand__")
    __ior__ = _writing("__ior__")
    __ixor__ = _writing("__ixor__")
    fill = _writing("fill")
    partition = _writing("partition")
    put = _writing("put")
    sort = _writing("sort")


def view_of(typecode: str, count: int, part: memoryview) -> SequenceView:
    """View little-endian numbers, on a little-endian machine. TypeError if the bytes are fewer."""
    return SequenceView(count, _DTYPES[typecode], part)


class _Decoders(dict[type[Any], Callable[[bytes], Any]]):
    """Class -> the function that makes a message with views of bytes that hold one."""

    __slots__ = ()

    def __missing__(self, cls: type[Any]) -> Callable[[bytes], Any]:
        decoder = self[cls] = _decoder(cls)
        return decoder


decoders = _Decoders()


def _has_sequences(cls: type[Any]) -> bool:
    """Whether the message, or one that it nests, has numeric sequences."""
    return any(
        _has_sequences(field.type)
        if isinstance(field.type, type)
        else field.is_sequence and isinstance(field.type, Basic) and bool(field.type.typecode)
        for field in fields_of(cls)
    )


def _decoder(cls: type[Any]) -> Callable[[bytes], Any]:
    decode = decoder_in_python(cls)
    if decode is None:  # rosidl compiled it, and publishes memory as it is, whatever its byte order
        return lambda data: decode_any(data, cls, views=(data[1:2] == b"\1") == (byteorder == "little"))
    has_codec = "__codec__" in vars(cls)  # not a class that users derive, or of an older ifgen
    if not _has_sequences(cls):
        return attached(cls)[1] if has_codec else decode
    in_python = _decoder_in_python(cls, decode)
    extension = chosen().extension
    if not has_codec or extension is None:
        return in_python
    attached(cls)
    return extension.codec_viewer(cls, SequenceView, in_python)  # type: ignore[no-any-return]


def _decoder_in_python(cls: type[Any], decode: Callable[..., Any]) -> Callable[[bytes], Any]:
    if _takes_views(decode):
        return lambda data: decode(data, view_of)
    return lambda data: decode_any(data, cls, views=True)


def _takes_views(decode: Any) -> bool:
    """Whether a generated function can make views: not that of an older ifgen, or of a large message."""
    code = getattr(decode, "__code__", None)
    return code is not None and code.co_varnames[: code.co_argcount] == ("data", "views")
