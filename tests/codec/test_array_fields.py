"""Fields of numbers from numpy arrays and buffers: setter, constructor and `from_dict` have one rule."""

from __future__ import annotations

import ctypes
import mmap
import os
import subprocess
import sys
from array import array
from collections.abc import Callable
from decimal import Decimal
from struct import pack
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from ifgen_runtime import ConversionError, deserialize, from_dict, serialize, to_dict
from ifgen_runtime.field_types import BASIC_TYPES, Basic, Field, fields_of
from ifgen_runtime.lazy import numpy as lazy_numpy

from .support import ROOT, Classes

Take = Callable[[type[Any], str, Any], Any]
KINDS = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"]
DTYPES = [f"{order}{kind}" for order in "<>" for kind in KINDS]


def assigned(cls: type[Any], field: str, value: Any) -> Any:
    """A message whose field was set."""
    message = cls()
    setattr(message, field, value)
    return message


TAKES: dict[str, Take] = {
    "setter": assigned,
    "constructor": lambda cls, field, value: cls(**{field: value}),
    "from_dict": lambda cls, field, value: from_dict(cls, {field: value}),
}


@pytest.fixture(params=TAKES.values(), ids=TAKES)
def take(request: pytest.FixtureRequest) -> Take:
    """Each way from a value to a message."""
    found: Take = request.param
    return found


def numeric_fields(cls: type[Any]) -> list[Field]:
    """The fields that hold several numbers."""
    return [field for field in fields_of(cls) if field.is_collection and getattr(field.type, "typecode", "")]


def fits(value: Any, type_: Basic) -> bool:
    """Whether the type has this number; a float may be rounded, but not to infinity."""
    if not type_.is_float:
        low, high = type_.range
        return not (isinstance(value, float) and not value.is_integer()) and low <= value <= high
    try:
        pack(f"<{type_.format}", value)
    except OverflowError:
        return False
    return True


def arrays() -> st.SearchStrategy[Any]:
    """Arrays of every dtype with numbers, of up to three dimensions, contiguous or not."""
    shapes = hnp.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=4)
    layouts = st.sampled_from([lambda a: a, np.transpose, lambda a: a[..., ::-1], lambda a: a[::2]])
    made = hnp.arrays(st.sampled_from(["?", *DTYPES]), shapes)
    small = hnp.arrays(st.sampled_from(["i8", "f8", ">f4"]), shapes, elements=st.integers(-1, 130))
    return st.tuples(made | small, layouts).map(lambda drawn: drawn[1](drawn[0]))


@settings(max_examples=120)
@given(data=st.data())
def test_any_array(classes: Classes, data: st.DataObject) -> None:
    _take_any_array(classes, data)


@pytest.mark.slow
@settings(max_examples=500)
@given(data=st.data())
def test_many_arrays(classes: Classes, data: st.DataObject) -> None:
    _take_any_array(classes, data)


def _take_any_array(classes: Classes, data: st.DataObject) -> None:
    """Each array becomes the same numbers, or the error names the first that does not fit."""
    cls = classes[f"codec_msgs/msg/{data.draw(st.sampled_from(['Sequences', 'Arrays']))}"]
    field = data.draw(st.sampled_from(numeric_fields(cls)))
    assert isinstance(field.type, Basic)
    value = data.draw(arrays())
    take = data.draw(st.sampled_from([assigned, TAKES["constructor"]] if field.size else [*TAKES.values()]))
    numbers = value.ravel().tolist()
    unfit = [index for index, number in enumerate(numbers) if not fits(number, field.type)]
    if unfit:
        with pytest.raises(ConversionError) as raised:
            take(cls, field.name, value)
        assert raised.value.path == f"{cls.__name__}.{field.name}[{unfit[0]}]"
        assert repr(numbers[unfit[0]]) in raised.value.problem
        return
    stored = getattr(take(cls, field.name, value), field.name)
    expected = np.array(numbers, field.type.dtype)
    if field.is_sequence:
        assert (type(stored), stored.typecode) == (array, field.type.typecode)
        assert stored.tobytes() == expected.tobytes()
    else:
        assert (stored.dtype, stored.shape, stored.flags.c_contiguous) == (expected.dtype, value.shape, True)
        assert stored.tobytes() == expected.tobytes()


@pytest.mark.parametrize("name", [name for name, basic in BASIC_TYPES.items() if basic.typecode])
def test_contiguous_arrays_of_the_own_type_take_the_short_way(
    classes: Classes, name: str, take: Take, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing but the buffer is read: numpy's functions are not called."""
    basic, cls = BASIC_TYPES[name], classes["codec_msgs/msg/Sequences"]
    field = next(field.name for field in numeric_fields(cls) if field.type == basic)
    value = np.arange(24, dtype=basic.dtype).reshape(2, 3, 4)
    monkeypatch.setattr(lazy_numpy, "asarray", None)
    for same in (value, memoryview(value), value.ravel(), array(basic.typecode, range(24))):
        assert getattr(take(cls, field, same), field) == array(basic.typecode, range(24))


class Exposed:
    """An image of another library: it has numpy's interface, and no buffer."""

    def __init__(self, values: Any) -> None:
        self.__array_interface__ = values.__array_interface__


class Converted:
    """A tensor of another library: numpy asks it for an array."""

    def __init__(self, values: Any) -> None:
        self.values = values

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return self.values


FRAME = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
READ_ONLY = FRAME.copy()
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    "value",
    [
        *(FRAME, READ_ONLY, FRAME.tobytes(), bytearray(FRAME), memoryview(FRAME), np.asfortranarray(FRAME)),
        *(FRAME.astype(dtype) for dtype in DTYPES if dtype[1:] != "i1"),
        *(FRAME.astype(object), np.ma.array(FRAME), FRAME.view(np.recarray)),
        *(
            Exposed(FRAME),
            Converted(FRAME),
            (ctypes.c_ubyte * 24)(*range(24)),
            (ctypes.c_int * 24)(*range(24)),
        ),
        *(array("d", range(24)), array("q", range(24)), range(24), [*range(24)], iter(range(24))),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_an_image_takes(classes: Classes, value: Any) -> None:
    image = assigned(classes["sensor_msgs/msg/Image"], "data", value)
    assert image.data == array("B", range(24))


def test_a_memory_map(classes: Classes) -> None:
    with mmap.mmap(-1, 4096) as mapped:
        mapped[:3] = b"abc"
        image = classes["sensor_msgs/msg/Image"](data=mapped)
    assert image.data[:4].tolist() == [97, 98, 99, 0]


def test_the_message_has_numbers_of_its_own(classes: Classes, take: Take) -> None:
    frame, covariance = FRAME.copy(), np.full((3, 3), 0.1)
    image = take(classes["sensor_msgs/msg/Image"], "data", frame)
    imu = take(classes["sensor_msgs/msg/Imu"], "orientation_covariance", covariance)
    frame[:], covariance[:] = 7, 7.0
    assert image.data == array("B", range(24))
    assert imu.orientation_covariance.ravel().tolist() == [0.1] * 9
    assert deserialize(serialize(imu), type(imu)).orientation_covariance.tolist() == [0.1] * 9


def test_bytes_of_a_fixed_array_are_numbers(classes: Classes) -> None:
    """A sequence takes `bytes` as memory, as array.array does; numpy reads a bytearray as numbers."""
    uuid = classes["unique_identifier_msgs/msg/UUID"]
    for sixteen in (bytes(range(16)), bytearray(range(16)), memoryview(bytes(range(16)))):
        assert uuid(uuid=sixteen).uuid.tolist() == [*range(16)]
    arrays, sequences = classes["codec_msgs/msg/Arrays"], classes["codec_msgs/msg/Sequences"]
    assert arrays(uint16s=b"\1\2").uint16s.tolist() == [1, 2]
    assert sequences(uint16s=b"\1\0\2\0").uint16s.tolist() == [1, 2]
    with pytest.raises(
        ConversionError, match=r"^Arrays.int8s\[1\]: expected an integer in \[-128, 127\], got 200$"
    ):
        arrays(int8s=b"\1\xc8\1")


REFUSED: list[tuple[str, Any, type[Exception], str]] = [
    (
        "uint8s",
        np.array([1, 300]),
        ValueError,
        "Sequences.uint8s[1]: expected an integer in [0, 255], got 300",
    ),
    (
        "uint8s",
        np.array([[0.0, 1.0], [0.5, 2.0]]),
        ValueError,
        "Sequences.uint8s[2]: expected an integer in [0, 255], got 0.5 at [1, 0] of the array",
    ),
    (
        "int16s",
        np.array([np.nan]),
        ValueError,
        "Sequences.int16s[0]: expected an integer in [-32768, 32767], got nan",
    ),
    ("int16s", np.array([0.0, -np.inf]), ValueError, "[1]: expected an integer in [-32768, 32767], got -inf"),
    ("uint64s", np.array([2.0**64]), ValueError, "got 1.8446744073709552e+19"),
    ("int64s", np.array([2**63], np.uint64), ValueError, "got 9223372036854775808"),
    (
        "uint8s",
        array("i", [1, -1]),
        ValueError,
        "Sequences.uint8s[1]: expected an integer in [0, 255], got -1",
    ),
    ("floats", np.array([0.1, 1e39]), ValueError, "Sequences.floats[1]: 1e+39 does not fit into a float32"),
    ("doubles", np.array([0.1, "a"], object), ValueError, "doubles[1]: expected a float64, got 'a'"),
    (
        "int8s",
        np.array([1, Decimal(2)], object),
        ValueError,
        "int8s[1]: expected an integer in [-128, 127], got Dec",
    ),
    (
        "doubles",
        np.ma.array([[0.1, 0.2], [0.3, 0.4]], mask=[[0, 0], [0, 1]]),
        ValueError,
        "Sequences.doubles[3]: the value at [1, 1] of the array is masked: fill it first, as value.filled(0) does",
    ),
    (
        "doubles",
        np.array(0.1),
        TypeError,
        "Sequences.doubles: expected a sequence of numbers, got a single value: a",
    ),
    (
        "doubles",
        np.float64(0.1),
        TypeError,
        "expected a sequence of numbers, got a single value: np.float64(0.1)",
    ),
    ("uint8s", np.array(["1"]), TypeError, "Sequences.uint8s: expected numbers, got an array of <U1"),
    ("uint8s", np.array([b"1"]), TypeError, "Sequences.uint8s: expected numbers, got an array of |S1"),
    ("doubles", np.array([1j]), TypeError, "Sequences.doubles: expected numbers, got an array of complex128"),
    (
        "int64s",
        np.array(["2026-01-01"], "M8[s]"),
        TypeError,
        "expected numbers, got an array of datetime64[s]",
    ),
    (
        "uint8s",
        np.zeros(2, [("x", "f4"), ("y", "f4")]),
        TypeError,
        "Sequences.uint8s: expected numbers, got a structured array with the fields x, y",
    ),
]


@pytest.mark.parametrize(("field", "value", "error", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_refused(
    classes: Classes, field: str, value: Any, error: type[Exception], text: str, take: Take
) -> None:
    """The error says where, and which value. The message keeps its old one."""
    cls = classes["codec_msgs/msg/Sequences"]
    with pytest.raises(ValueError if take is TAKES["from_dict"] else error) as raised:
        take(cls, field, value)
    shown = text if np.__version__ >= "2" else text.replace("np.float64(0.1)", "0.1")
    assert shown in str(raised.value)
    message = cls(**{field: [1, 2]})
    with pytest.raises(error):
        setattr(message, field, value)
    assert getattr(message, field).tolist() == [1, 2]


def test_what_floats_keep(classes: Classes) -> None:
    """Infinity, nan, and floats of 32 bits that are rounded are no errors."""
    floats = classes["codec_msgs/msg/Sequences"](
        floats=np.array([0.1, np.inf, -np.inf, np.nan, 3.4e38])
    ).floats
    assert floats[:3].tolist() == [np.float32(0.1), np.inf, -np.inf]
    assert np.isnan(floats[3]) and floats[4] == np.float32(3.4e38)


@pytest.mark.parametrize("field", ["uint8s", "doubles"])
def test_texts_are_not_bytes(classes: Classes, field: str) -> None:
    sequences = classes["codec_msgs/msg/Sequences"]
    for value in ("12", np.str_("12")):
        with pytest.raises(TypeError, match="cannot use a str"):
            setattr(sequences(), field, value)
    arrays = classes["codec_msgs/msg/Arrays"]
    with pytest.raises(TypeError, match=r"^Arrays.int8s: expected numbers, got str$"):
        arrays(int8s="12")  # numpy would take it for 12


def test_sizes_are_checked_when_a_message_is_sent(classes: Classes) -> None:
    """As with lists, and as rosidl; `from_dict` checks at once."""
    bounds, imu = classes["codec_msgs/msg/Bounds"], classes["sensor_msgs/msg/Imu"]
    for cls, field, value, text in (
        (bounds, "octets", np.zeros((2, 2), np.uint8), "Bounds.octets: expected at most 2 elements, got 4"),
        (
            imu,
            "orientation_covariance",
            np.zeros((2, 2)),
            "orientation_covariance: expected 9 elements, got 4",
        ),
    ):
        with pytest.raises(ValueError, match=text):
            serialize(assigned(cls, field, value))
        with pytest.raises(ConversionError, match=text):
            from_dict(cls, {field: value})


def test_with_checks(classes: Classes) -> None:
    """The constructor converts before it checks, as rosidl's. Setters refuse what rosidl's refuse, with advice."""
    image, bounds = classes["sensor_msgs/msg/Image"], classes["codec_msgs/msg/Bounds"]
    checked = image(data=FRAME, check_fields=True)
    assert checked.data == array("B", range(24))
    with pytest.raises(
        ConversionError, match=r"^Image.data\[5\]: expected an integer in \[0, 255\], got 300 at"
    ):
        image(data=FRAME.astype(int) + 295 * (FRAME == 5), check_fields=True)
    with pytest.raises(AssertionError, match=r"array.array\(\) must have a size <= 2"):
        bounds(octets=FRAME, check_fields=True)
    with pytest.raises(AssertionError, match="The 'data' field must be a set or sequence") as raised:
        checked.data = FRAME
    advice = raised.value.__notes__[0]
    assert advice.startswith("as in rosidl, no numpy array passes this check; ")
    passing = advice.removesuffix(" does").partition("; ")[2]
    checked.data = eval(passing, {"array": sys.modules["array"], "value": FRAME + 1})
    assert checked.data == array("B", range(1, 25))
    checked.data = FRAME.tobytes()
    assert checked.data == array("B", range(24))


def test_an_error_does_not_hold_the_value(classes: Classes) -> None:
    """An array.array cannot grow while something views it, such as the traceback of an error."""
    value = array("d", [0.5])
    with pytest.raises(ConversionError) as raised:
        classes["sensor_msgs/msg/Image"]().data = value
    value.append(1.0)
    assert raised.value.path == "Image.data[0]"


def test_values_without_numpy_do_not_import_it() -> None:
    program = """
import sys
from sensor_msgs.msg import Image
image = Image()
for value in ([1], (1,), b"a", bytearray(b"a"), memoryview(b"a"), __import__("array").array("B", b"a")):
    image.data = value
    Image(data=value)
assert "numpy" not in sys.modules
"""
    environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'generated'}:{ROOT / 'codegen'}"}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True, timeout=60)


@pytest.mark.parametrize(
    ("field", "value", "elements"),
    [
        ("flags", np.array([[True, False], [False, True]]), [True, False, False, True]),
        ("raw", b"ab", [b"a", b"b"]),
        ("raw", np.array([[0, 255]]), [b"\0", b"\xff"]),
        ("raw", memoryview(b"ab"), [b"a", b"b"]),
        ("characters", np.array([1, 2], np.uint8), [1, 2]),
        ("texts", np.array([["a", "bc"]]), ["a", "bc"]),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, memoryview) else str(value),
)
def test_arrays_in_fields_of_lists(classes: Classes, field: str, value: Any, elements: list[Any]) -> None:
    """Such a field keeps what it is given, as rosidl's; what is sent, and `to_dict`, have the elements."""
    cls = classes["codec_msgs/msg/Sequences"]
    message = assigned(cls, field, value)
    received, expected = deserialize(serialize(message), cls), cls(**{field: elements})
    assert received == from_dict(cls, {field: value}) == expected
    assert to_dict(message) == to_dict(expected)


def test_what_fields_of_lists_refuse(classes: Classes) -> None:
    cls = classes["codec_msgs/msg/Sequences"]
    for field, value, text in (
        ("flags", np.array([1, 0]), r"^Sequences.flags\[0\]: expected bool, got int$"),
        ("flags", b"ab", r"^Sequences.flags"),
        ("raw", np.array([1, 300]), r"^Sequences.raw\[1\]: expected an integer in \[0, 255\], got 300$"),
        ("texts", np.array([1]), r"^Sequences.texts\[0\]: expected str, got int$"),
    ):
        for use in (serialize, to_dict):
            with pytest.raises(ValueError, match=text):
                use(assigned(cls, field, value))
        with pytest.raises(ValueError, match=text):
            from_dict(cls, {field: value})


def test_a_matrix_in_a_dictionary_is_one_list(classes: Classes) -> None:
    imu = classes["sensor_msgs/msg/Imu"](orientation_covariance=np.diag([0.1, 0.2, 0.3]))
    plain = to_dict(imu)
    assert plain["orientation_covariance"] == [0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3]
    assert to_dict(from_dict(type(imu), plain)) == plain
