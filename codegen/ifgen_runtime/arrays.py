"""Fields of numbers from whatever holds numbers: numpy arrays, buffers, sequences, iterables.

Generated setters and constructors read lists and the like themselves, and come here with all other values.
Message packages load this module when they first do so, and numpy only for values that need it.
"""

from __future__ import annotations

from array import array
from collections import deque
from itertools import chain

from ifgen_runtime.copying import ITERABLES
from ifgen_runtime.errors import Problem, WrongKind
from ifgen_runtime.lazy import numeric, numpy

TYPE_CHECKING = False  # typing itself takes longer to import than this module
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    from numpy.typing import NDArray

    class Buffer(Protocol):
        """An object with the buffer protocol, which Python itself has a name for since 3.12."""

        def __buffer__(self, flags: int, /) -> memoryview: ...

    AnyArray: TypeAlias = NDArray[Any]
else:

    class Buffer:
        """An object with the buffer protocol, in the annotations of constructors."""

    def __getattr__(name):
        if name != "AnyArray":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from typing import Any  # only programs that evaluate annotations ask

        return numpy.typing.NDArray[Any]


# These have no buffer, or array.array copies it.
_READ_BY_ARRAY = ITERABLES | {deque, chain, bytes, bytearray}
_FORMATS = {code: frozenset({code}) for code in "bBhHiIqQfd"}
for _same in ("il", "IL") if array("l").itemsize == 4 else ("ql", "QL"):
    _FORMATS[_same[0]] = frozenset(_same)  # numpy's int64 is a long where that has 8 bytes


def array_of(typecode: str, value: Any) -> array[Any]:
    """Make an array.array of the numbers in `value`: one copy if it is a buffer, of any shape.

    An array of another dtype is converted if each value fits. `bytes` and `bytearray` are the memory of the
    items, as for array.array itself. Raise Problem, whose place is the index of the first value that does not
    fit, and WrongKind for arrays that do not hold numbers.
    """
    cls = value.__class__
    if (cls is array and value.typecode == typecode) or cls in _READ_BY_ARRAY:
        return array(typecode, value)
    try:
        view = memoryview(value)
    except (TypeError, ValueError, BufferError):  # numpy raises ValueError for dates
        return _array_of_other(typecode, value)
    with view:
        if (
            view.format in _FORMATS[typecode]
            and view.c_contiguous
            and view.ndim
            and not hasattr(value, "mask")
        ):
            numbers: array[Any] = array(typecode)
            if view.nbytes:  # cast() refuses shapes with a zero
                numbers.frombytes(view.cast("B"))
            return numbers
    return _array_of_other(typecode, value)


def _array_of_other(typecode: str, value: Any) -> array[Any]:
    values = _viewed(value)
    if values is None:
        return array(typecode, value)
    if not values.ndim:
        raise _single(value)
    numbers = array(typecode, bytes(array(typecode).itemsize)) * values.size
    _fill(numpy.ndarray(values.shape, typecode, numbers), values)
    return numbers


def ndarray_of(dtype: type[Any], value: Any) -> NDArray[Any]:
    """Make a contiguous numpy array of this dtype and of the shape of `value`, with the rules of `array_of`.

    But `bytes` and `bytearray` are numbers from 0 to 255, as numpy reads a bytearray.
    """
    cls = value.__class__
    if cls is numeric.ndarray and (own := value.dtype).type is dtype and own.isnative and value.ndim:
        return value.copy()  # type: ignore[no-any-return]  # mypy takes it for Any
    if cls in ITERABLES:
        return numpy.array(value, dtype)
    if cls is array and (copied := numpy.array(value)).dtype.type is dtype:
        return copied
    if isinstance(value, (bytes, bytearray)):
        value = memoryview(value)
    if isinstance(value, str):
        raise WrongKind("expected numbers, got str")  # numpy would read "12" as 12
    values = _viewed(value)
    if values is None:
        return numpy.array(value, dtype)
    if not values.ndim:
        raise _single(value)
    numbers = numpy.empty(values.shape, dtype)
    _fill(numbers, values)
    return numbers


def is_array(value: Any) -> bool:
    """Whether the value is a buffer, or an object that numpy can view; `bytes` and `bytearray` are not."""
    if isinstance(value, (str, bytes, bytearray)):
        return False
    if hasattr(value, "__array__") or hasattr(value, "__array_interface__"):
        return True
    try:
        memoryview(value).release()
    except TypeError:
        return False
    return True


def _viewed(value: Any) -> NDArray[Any] | None:
    """View an array as one of numpy's; None for anything else."""
    if not is_array(value):
        return None
    if hasattr(value, "mask") and hasattr(value, "filled"):
        masked = numpy.ma.getmaskarray(value)
        _refuse_first(masked, "the value{place} is masked: fill it first, as value.filled(0) does")
    return numpy.asarray(value)


def _fill(numbers: NDArray[Any], values: NDArray[Any]) -> None:
    """Copy all values into an array of another type and the same shape, if they fit."""
    if values.dtype.kind == "O":
        values = _from_objects(values, numbers.dtype)
    elif values.dtype.kind not in "biuf":
        raise WrongKind(f"expected numbers, got {_kind(values.dtype)}")
    if numpy.can_cast(values.dtype, numbers.dtype):
        numbers[...] = values
    elif numbers.dtype.kind == "f":
        _fill_floats(numbers, values)
    else:
        _refuse_outside(values, numbers.dtype)
        numbers[...] = values


def _fill_floats(numbers: NDArray[Any], values: NDArray[Any]) -> None:
    with numpy.errstate(over="ignore"):
        numbers[...] = values
    infinite = numpy.isinf(numbers)
    if infinite.any() and values.dtype.kind == "f":
        _refuse_first(
            infinite & numpy.isfinite(values),
            "{value}{place} does not fit into a " + str(numbers.dtype),
            values,
        )


def _refuse_outside(values: NDArray[Any], dtype: numpy.dtype[Any]) -> None:
    """Refuse values that are not integers of this dtype."""
    if not values.size:
        return
    limits = numpy.iinfo(dtype)
    low, high = int(limits.min), int(limits.max)
    if values.dtype.kind == "f":
        if values.dtype.itemsize == 2:  # float16 has no 65536
            values = values.astype(numpy.float32)
        inside = (values >= float(low)) & (values < float(high + 1)) & (values == numpy.trunc(values))
        outside = ~inside  # nan, too
    elif low <= int(values.min()) and int(values.max()) <= high:
        return
    else:
        outside = (values < low) | (values > high)
    _refuse_first(outside, f"expected {_expected(dtype)}, got {{value}}{{place}}", values)


def _refuse_first(wrong: NDArray[Any], text: str, values: NDArray[Any] | None = None) -> None:
    """Raise a Problem with the first of the wrong values, if there is one.

    In the text, `{value}` is that value and `{place}` its place in an array of several dimensions.
    """
    if not wrong.any():
        return
    index = int(wrong.argmax())
    value = "" if values is None else values.flat[index].item()
    indices = ", ".join(map(str, numpy.unravel_index(index, wrong.shape)))
    place = f" at [{indices}] of the array" if wrong.ndim > 1 else ""
    raise Problem(text.format(value=value, place=place)).at(f"[{index}]")


def _single(value: Any) -> Problem:
    return WrongKind(f"expected a sequence of numbers, got a single value: {_shown(value)}")


def _from_objects(values: NDArray[Any], dtype: numpy.dtype[Any]) -> NDArray[Any]:
    """The numbers of an array of Python objects, with the rules for lists."""
    typecode = "d" if dtype.kind == "f" else dtype.char
    objects = values.ravel().tolist()
    try:
        return numpy.array(array(typecode, objects)).reshape(values.shape)
    except (TypeError, OverflowError):
        for index, value in enumerate(objects):
            try:
                array(typecode, [value])
            except (TypeError, OverflowError):
                text = f"expected {_expected(dtype)}, got {_shown(value)}"
                raise Problem(text).at(f"[{index}]") from None
        raise


def _expected(dtype: numpy.dtype[Any]) -> str:
    if dtype.kind == "f":
        return f"a {dtype}"
    limits = numpy.iinfo(dtype)
    return f"an integer in [{limits.min}, {limits.max}]"


def _kind(dtype: numpy.dtype[Any]) -> str:
    if dtype.names:
        return f"a structured array with the fields {', '.join(dtype.names)}"
    return f"an array of {dtype}"


def _shown(value: Any) -> str:
    from ifgen_runtime.codec.encoding import shown  # only for an error

    return shown(value)
