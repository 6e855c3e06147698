"""Values that the wire cannot hold are refused, and the error says where and why."""

from __future__ import annotations

import copy
import pickle
from array import array
from collections import UserString
from typing import Any

import numpy
import pytest
from ifgen_runtime import (
    CodecError,
    DeserializationError,
    SerializationError,
    TextEncodingError,
    deserialize,
    serialize,
)

from .support import Classes, SlowPathTaken, without_slow_path


class Index:
    """An object that can be used as an integer."""

    def __index__(self) -> int:
        return 7


REFUSED: list[tuple[str, str, Any, str]] = [
    ("std_msgs/msg/Int8", "data", 128, "Int8.data: expected an integer in [-128, 127], got 128"),
    ("std_msgs/msg/Int8", "data", 10**5000, "Int8.data: expected an integer in [-128, 127], got int"),
    ("std_msgs/msg/UInt8", "data", -1, "UInt8.data: expected an integer in [0, 255], got -1"),
    ("std_msgs/msg/UInt64", "data", 2**64, "got 18446744073709551616"),
    ("std_msgs/msg/Int32", "data", 1.0, "Int32.data: expected int, got float"),
    ("std_msgs/msg/Int32", "data", None, "Int32.data: expected int, got None"),
    ("std_msgs/msg/Int32", "data", int, "Int32.data: expected an integer"),
    ("std_msgs/msg/Float64", "data", 1, "Float64.data: expected float, got int"),
    ("std_msgs/msg/Float64", "data", True, "Float64.data: expected float, got bool"),
    ("std_msgs/msg/Float64", "data", "1", "Float64.data: expected float, got str"),
    ("std_msgs/msg/Float64", "data", numpy.float32(1), "Float64.data: expected float, got numpy.float32"),
    ("std_msgs/msg/Float32", "data", 1e39, "Float32.data: 1e+39 does not fit into a float32"),
    ("std_msgs/msg/Bool", "data", 1, "Bool.data: expected bool, got int"),
    ("std_msgs/msg/Bool", "data", "yes", "Bool.data: expected bool, got str"),
    ("std_msgs/msg/Byte", "data", b"", "Byte.data: expected bytes of length 1, got length 0"),
    ("std_msgs/msg/Byte", "data", b"ab", "Byte.data: expected bytes of length 1, got length 2"),
    ("std_msgs/msg/Byte", "data", 1, "Byte.data: expected bytes of length 1, got int"),
    ("std_msgs/msg/Byte", "data", "a", "Byte.data: expected bytes of length 1, got str"),
    ("codec_msgs/msg/Letter", "a", "", "Letter.a: expected str of length 1, got length 0"),
    ("codec_msgs/msg/Letter", "a", "ab", "Letter.a: expected str of length 1, got length 2"),
    ("codec_msgs/msg/Letter", "a", 65, "Letter.a: expected str of length 1, got int"),
    ("codec_msgs/msg/Letter", "a", b"a", "Letter.a: expected str of length 1, got bytes"),
    ("codec_msgs/msg/Letter", "a", "日", "Letter.a: '日' is above U+00FF: a char is one byte"),
    ("codec_msgs/msg/Letters", "many", ["a", ""], "Letters.many[1]: expected str of length 1, got length 0"),
    ("codec_msgs/msg/Letters", "many", "ab", "Letters.many: expected a list, got str"),
    ("std_msgs/msg/String", "data", b"a", "String.data: expected str, got bytes"),
    ("std_msgs/msg/String", "data", None, "String.data: expected str, got None"),
    ("std_msgs/msg/String", "data", 3, "String.data: expected str, got int"),
    ("std_msgs/msg/String", "data", [], "String.data: expected str, got list"),
    (
        "std_msgs/msg/String",
        "data",
        "a\0b",
        "String.data: NUL at character 1: a string ends there on the wire",
    ),
    ("std_msgs/msg/String", "data", "ab\ud800", "String.data: half of a surrogate pair at character 2"),
    ("std_msgs/msg/String", "data", "x" * 99 + "\0", "String.data: NUL at character 99"),
    ("codec_msgs/msg/Wide", "text", "\udc00", "Wide.text: half of a surrogate pair at character 0"),
    ("codec_msgs/msg/Wide", "text", None, "Wide.text: expected str, got None"),
    ("codec_msgs/msg/Wide", "bounded", "abcd", "Wide.bounded: expected at most 3 characters, got 4"),
    ("codec_msgs/msg/Wide", "many", ["a", 1], "Wide.many[1]: expected str, got int"),
    ("codec_msgs/msg/Wide", "pair", ["", "abc"], "Wide.pair[1]: expected at most 2 characters, got 3"),
    ("geometry_msgs/msg/Twist", "linear", None, "Twist.linear: expected geometry_msgs/msg/Vector3, got None"),
    ("geometry_msgs/msg/Twist", "linear", 1.0, "Twist.linear: expected geometry_msgs/msg/Vector3, got float"),
    ("codec_msgs/msg/Bounds", "text", "123456", "Bounds.text: expected at most 5 characters, got 6"),
    ("codec_msgs/msg/Bounds", "texts", ["1234"], "Bounds.texts[0]: expected at most 3 characters, got 4"),
    ("codec_msgs/msg/Bounds", "pair", [""], "Bounds.pair: expected 2 elements, got 1"),
    ("codec_msgs/msg/Bounds", "pair", ["", "", ""], "Bounds.pair: expected 2 elements, got 3"),
    (
        "codec_msgs/msg/Bounds",
        "few_texts",
        ["", "", ""],
        "Bounds.few_texts: expected at most 2 elements, got 3",
    ),
    (
        "codec_msgs/msg/Bounds",
        "numbers",
        array("d", bytes(32)),
        "numbers: expected at most 3 elements, got 4",
    ),
    ("codec_msgs/msg/Bounds", "flags", [True] * 3, "Bounds.flags: expected at most 2 elements, got 3"),
    ("codec_msgs/msg/Bounds", "flags", [True, 1], "Bounds.flags[1]: expected bool, got int"),
    ("codec_msgs/msg/Bounds", "raw", [b"a", b""], "Bounds.raw[1]: expected bytes of length 1, got length 0"),
    ("codec_msgs/msg/Bounds", "raw", [b"ab", b""], "Bounds.raw[0]: expected bytes of length 1, got length 2"),
    ("codec_msgs/msg/Bounds", "raw", b"abc", "Bounds.raw: expected at most 2 elements, got 3"),
    ("codec_msgs/msg/Bounds", "flags", b"ab", "Bounds.flags: expected a list, got bytes"),
    (
        "codec_msgs/msg/Bounds",
        "empties",
        [None],
        "Bounds.empties[0]: expected codec_msgs/msg/Empty, got None",
    ),
    ("codec_msgs/msg/Sequences", "texts", "abc", "Sequences.texts: expected a list, got str"),
    ("codec_msgs/msg/Sequences", "texts", None, "Sequences.texts: expected a list, got None"),
    ("codec_msgs/msg/Sequences", "texts", ["a", None], "Sequences.texts[1]: expected str, got None"),
    ("codec_msgs/msg/Sequences", "texts", ["a", "\0"], "Sequences.texts[1]: NUL at character 0"),
    ("codec_msgs/msg/Sequences", "doubles", array("f"), "expected array.array('d'), got array.array('f')"),
    ("codec_msgs/msg/Sequences", "int64s", array("l"), "expected array.array('q'), got array.array('l')"),
    ("codec_msgs/msg/Sequences", "doubles", numpy.zeros(1, "f4"), "expected dtype float64, got <f4"),
    ("codec_msgs/msg/Sequences", "doubles", numpy.zeros(1, ">f4"), "expected dtype float64, got >f4"),
    ("codec_msgs/msg/Sequences", "doubles", [1.0, "2"], "Sequences.doubles[1]: expected float, got str"),
    ("codec_msgs/msg/Sequences", "doubles", "12", "Sequences.doubles: expected array.array('d'), got str"),
    ("codec_msgs/msg/Sequences", "uint8s", [1, 256], "uint8s[1]: expected an integer in [0, 255], got 256"),
    ("codec_msgs/msg/Arrays", "large", numpy.zeros(99), "Arrays.large: expected 100 elements, got 99"),
    (
        "codec_msgs/msg/Arrays",
        "large",
        numpy.zeros(100, "f4"),
        "Arrays.large: expected dtype float64, got <f4",
    ),
    ("codec_msgs/msg/Arrays", "floats", numpy.zeros(4, "f4"), "Arrays.floats: expected 3 elements, got 4"),
    ("codec_msgs/msg/Arrays", "floats", None, "Arrays.floats: expected numpy.ndarray, got None"),
    ("codec_msgs/msg/Arrays", "flags", [True, False], "Arrays.flags: expected 3 elements, got 2"),
    ("codec_msgs/msg/Arrays", "pairs", [], "Arrays.pairs: expected 2 elements, got 0"),
]


@pytest.mark.parametrize(("name", "field", "value", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_refused(classes: Classes, name: str, field: str, value: Any, text: str) -> None:
    message = classes[name]()
    setattr(message, f"_{field}", value)
    with pytest.raises(SerializationError) as caught:
        serialize(message)
    assert text in str(caught.value)
    assert caught.value.path.partition("[")[0] == f"{type(message).__name__}.{field}"


def test_path_leads_into_nested_messages(classes: Classes) -> None:
    path, pose = classes["nav_msgs/msg/Path"](), classes["geometry_msgs/msg/PoseStamped"]
    path.poses = [pose() for _ in range(3)]
    path.poses[2].pose.position.y = 1
    with pytest.raises(SerializationError) as caught:
        serialize(path)
    assert str(caught.value) == "Path.poses[2].pose.position.y: expected float, got int"
    path.poses[2] = pose().pose
    with pytest.raises(
        SerializationError,
        match=r"^Path.poses\[2\]: expected geometry_msgs/msg/PoseStamped, got geometry_msgs/msg/Pose$",
    ):
        serialize(path)
    marker = classes["visualization_msgs/msg/Marker"]()
    marker.points = [classes["geometry_msgs/msg/Point"](), classes["geometry_msgs/msg/Vector3"]()]
    with pytest.raises(
        SerializationError,
        match=r"^Marker.points\[1\]: expected geometry_msgs/msg/Point, got geometry_msgs/msg/Vector3$",
    ):
        serialize(marker)
    del marker.points[0].y, marker.points[1]
    with pytest.raises(SerializationError, match=r"^Marker.points\[0\].y: has no value$"):
        serialize(marker)


def test_errors_are_values(classes: Classes) -> None:
    error = SerializationError("Int8.data", "expected int, got float")
    assert isinstance(error, CodecError) and isinstance(error, ValueError)
    assert (
        str(pickle.loads(pickle.dumps(error)))
        == str(copy.copy(error))
        == "Int8.data: expected int, got float"
    )
    with pytest.raises(SerializationError, match=r"^int: expected a message, got int$"):
        serialize(3)
    with pytest.raises(DeserializationError, match=r"^Int8: expected bytes, got str$"):
        deserialize("abc", classes["std_msgs/msg/Int8"])  # type: ignore[arg-type]
    with pytest.raises(DeserializationError, match=r"^Int8: expected bytes, got int$"):
        deserialize(5, classes["std_msgs/msg/Int8"])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="is not a message class"):
        deserialize(b"", int)


ACCEPTED: list[tuple[str, str, Any, Any]] = [
    ("std_msgs/msg/Float64", "data", numpy.float64(1.5), 1.5),
    ("std_msgs/msg/Int8", "data", True, 1),
    ("std_msgs/msg/Int8", "data", numpy.int64(7), 7),
    ("std_msgs/msg/Int8", "data", Index(), 7),
    ("std_msgs/msg/Byte", "data", bytearray(b"a"), b"a"),
    ("std_msgs/msg/String", "data", numpy.str_("abc"), "abc"),
    ("codec_msgs/msg/Bounds", "text", UserString("abc"), "abc"),
    ("codec_msgs/msg/Sequences", "texts", ("a", "b"), ["a", "b"]),
    ("codec_msgs/msg/Sequences", "flags", (True, False), [True, False]),
    ("codec_msgs/msg/Sequences", "doubles", [1.0, 2.0], array("d", [1.0, 2.0])),
    ("codec_msgs/msg/Sequences", "doubles", numpy.array([1.0]), array("d", [1.0])),
    ("codec_msgs/msg/Sequences", "uint8s", b"ab", array("B", b"ab")),
    ("codec_msgs/msg/Sequences", "int32s", range(3), array("i", range(3))),
]


@pytest.mark.parametrize(("name", "field", "value", "received"), ACCEPTED)
def test_unusual_values_that_fit(classes: Classes, name: str, field: str, value: Any, received: Any) -> None:
    message = classes[name]()
    setattr(message, f"_{field}", value)
    assert getattr(deserialize(serialize(message), classes[name]), field) == received


def test_unusual_arrays_that_fit(classes: Classes) -> None:
    """Any shape and strides are accepted if dtype and size are right; a list too."""
    cls = classes["codec_msgs/msg/Arrays"]
    numbers = numpy.arange(200.0)
    for large in (numbers[:100].reshape(10, 10), numbers[::2], numbers[100:], list(map(float, range(100)))):
        message = cls()
        message._large = large
        received = deserialize(serialize(message), cls).large
        assert received.tolist() == numpy.asarray(large).ravel().tolist()
        message._uint16s = numpy.array([[1], [2]], "u2")
        assert deserialize(serialize(message), cls).uint16s.tolist() == [1, 2]


def test_objects_of_another_class_for_the_same_type(classes: Classes) -> None:
    """A node on real ROS has messages of rosidl's compiled classes: same names, same private slots."""
    vector, twist = classes["geometry_msgs/msg/Vector3"], classes["geometry_msgs/msg/Twist"]
    foreign = type(
        "Vector3", (), {"__slots__": ("_x", "_y", "_z"), "__module__": "geometry_msgs.msg._vector3"}
    )()
    foreign._x, foreign._y, foreign._z = 1.0, 2.0, 3.0
    assert serialize(twist(linear=foreign)) == serialize(twist(linear=vector(x=1.0, y=2.0, z=3.0)))
    message = twist(linear=vector(x=1.0, y=2.0, z=3.0), check_fields=True)
    with without_slow_path(twist):
        assert deserialize(serialize(message), twist) == message, "a message with checks takes the fast path"
    with without_slow_path(twist), pytest.raises(SlowPathTaken):
        serialize(twist(linear=foreign))


TEXTS = [
    ("Words.get_fields_and_field_types[1]", ["a", "\ud800"]),
    ("Bounds.text", "\ud800"),
    ("Bounds.texts[0]", ["\ud800"]),
    ("Bounds.pair[1]", ["a", "\ud800"]),
    ("Bounds.few_texts[1]", ["a", "\ud800"]),
    ("Arrays.texts[0]", ["\ud800", "a"]),
    ("Wide.text", "\ud800"),
    ("Wide.bounded", "\ud800"),
    ("Wide.many[1]", ["a", "\ud800"]),
    ("Wide.pair[0]", ["\ud800", "a"]),
]


@pytest.mark.parametrize(("path", "value"), TEXTS, ids=[path for path, _ in TEXTS])
@pytest.mark.parametrize("checks", [False, True])
def test_half_a_surrogate_pair_in_any_text(classes: Classes, path: str, value: Any, checks: bool) -> None:
    """The error has the path, and is the one of Python that programs written for rclpy catch."""
    name, _, field = path.partition(".")
    message = classes[f"codec_msgs/msg/{name}"](**{field.partition("[")[0]: value}, check_fields=checks)
    with pytest.raises(TextEncodingError) as raised:
        serialize(message)
    error = raised.value
    assert str(error) == f"{path}: half of a surrogate pair at character 0 cannot be sent"
    assert isinstance(error, SerializationError)
    assert isinstance(error, UnicodeEncodeError)
    assert (error.path, error.object, error.start) == (path, "\ud800", 0)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_another_field_that_is_wrong_first_is_no_matter_of_texts() -> None:
    from lifecycle_msgs.msg import Transition

    wrong = Transition(label="\ud800")
    wrong.id = {}  # type: ignore[assignment]
    with pytest.raises(SerializationError, match=r"Transition\.id: expected int, got dict") as raised:
        serialize(wrong)
    assert not isinstance(raised.value, UnicodeEncodeError)
