"""Dictionaries, YAML and JSON: the forms that people read and write, and their mistakes."""

from __future__ import annotations

import json
import math
from array import array
from typing import Any

import numpy
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import (
    ConversionError,
    deserialize,
    from_dict,
    from_json,
    from_yaml,
    serialize,
    to_dict,
    to_json,
    to_yaml,
)

from .strategies import messages
from .support import Classes


@settings(max_examples=150)
@given(data=st.data())
def test_there_and_back(classes: Classes, data: st.DataObject) -> None:
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    message = data.draw(messages(cls))
    plain = to_dict(message)
    assert from_dict(cls, plain) == message
    assert from_json(cls, to_json(message)) == message
    assert from_yaml(cls, to_yaml(message)) == message
    assert yaml.safe_load(to_yaml(message)) == plain
    assert serialize(from_json(cls, to_json(message, indent=2).encode())) == serialize(message)


@settings(max_examples=150)
@given(data=st.data())
def test_any_document(classes: Classes, data: st.DataObject) -> None:
    """Any JSON for a field becomes a message that can be sent, or a ConversionError."""
    values = st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3) | st.binary(max_size=3),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
        max_leaves=6,
    )
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    document = dict(to_dict(cls()))
    for name in data.draw(st.lists(st.sampled_from([*document, "unknown"]), max_size=2)):
        document[name] = data.draw(values)
    try:
        serialize(from_dict(cls, document))
    except ConversionError as error:
        assert error.path.startswith(cls.__name__)


@given(
    text=st.text(max_size=40) | st.sampled_from(["[" * 5000, "{" * 5000, "&a [*a]", "1" * 5000, "a: !!x 1"])
)
def test_any_text(classes: Classes, text: str) -> None:
    for read in (from_yaml, from_json):
        try:
            read(classes["geometry_msgs/msg/Vector3"], text)
        except ConversionError as error:
            assert error.path.startswith("Vector3")


def test_what_it_looks_like(classes: Classes) -> None:
    status = classes["diagnostic_msgs/msg/DiagnosticStatus"](level=b"\2", name="é", values=[])
    status.values.append(classes["diagnostic_msgs/msg/KeyValue"](key="k", value="v"))
    plain = {
        "level": 2,
        "name": "é",
        "message": "",
        "hardware_id": "",
        "values": [{"key": "k", "value": "v"}],
    }
    assert to_dict(status) == plain
    assert (
        to_yaml(status) == "level: 2\nname: é\nmessage: ''\nhardware_id: ''\nvalues:\n- key: k\n  value: v\n"
    )
    assert json.loads(to_json(status)) == plain
    imu = to_dict(classes["sensor_msgs/msg/Imu"]())
    assert imu["orientation_covariance"] == [0.0] * 9 and type(imu["orientation_covariance"]) is list
    words = classes["codec_msgs/msg/Words"](from_="a")
    assert next(iter(to_dict(words))) == "from", "the name in the definition"
    assert from_dict(type(words), {"from": "a"}) == words


def test_not_finite(classes: Classes) -> None:
    """JSON has no NaN and no infinity: they are strings, which no other field accepts as numbers."""
    vector = classes["geometry_msgs/msg/Vector3"]
    text = to_json(vector(x=math.nan, y=math.inf, z=-math.inf))
    assert text == '{"x": "NaN", "y": "Infinity", "z": "-Infinity"}'
    for back in (from_json(vector, text), from_yaml(vector, "{x: .nan, y: .inf, z: -.inf}")):
        assert math.isnan(back.x) and (back.y, back.z) == (math.inf, -math.inf)
    assert math.isnan(from_json(vector, '{"x": NaN}').x), "what other writers of JSON do"


def test_lenient_where_nothing_is_lost(classes: Classes) -> None:
    vector = classes["geometry_msgs/msg/Vector3"]
    assert from_dict(vector, {"x": 1, "z": 1e-3}) == vector(x=1.0, z=0.001)
    assert from_yaml(vector, "x: 1e-3\ny: 1e5") == vector(x=0.001, y=1e5), "YAML 1.1 reads these as strings"
    assert from_yaml(vector, "") == from_json(vector, "{}") == vector()
    assert from_dict(classes["geometry_msgs/msg/Twist"], {"linear": vector(x=1.0)}).linear.x == 1.0
    byte = classes["std_msgs/msg/Byte"]
    assert [from_dict(byte, {"data": data}).data for data in (7, b"\7", "\7")] == [b"\7"] * 3
    sequences, arrays = classes["codec_msgs/msg/Sequences"], classes["codec_msgs/msg/Arrays"]
    for octets in (b"ab", [97, 98], (97, 98), array("B", b"ab"), numpy.array([97, 98])):
        assert from_dict(sequences, {"uint8s": octets}).uint8s == array("B", b"ab")
    for name in ("int16s", "uint64s"):  # bytes are numbers, whatever the field's Python type is
        assert getattr(from_dict(sequences, {name: b"ab"}), name).tolist() == [97, 98]
    floats = from_dict(arrays, {"floats": [1, 2.5, "NaN"]}).floats
    assert floats.dtype == numpy.float32 and floats.tolist()[:2] == [1.0, 2.5]
    defaults = from_dict(classes["test_msgs/msg/Defaults"], {"int8_value": 1})
    assert (defaults.int8_value, defaults.uint8_value) == (1, 200), (
        "fields that are not mentioned keep theirs"
    )


REFUSED: list[tuple[str, Any, str]] = [
    ("geometry_msgs/msg/Vector3", {"w": 1.0}, "Vector3.w: no such field; its fields are: x, y, z"),
    ("std_msgs/msg/Empty", {"data": 1}, "Empty.data: no such field; its fields are: none"),
    ("geometry_msgs/msg/Vector3", {"x": "1"}, "Vector3.x: expected float, got str"),
    ("geometry_msgs/msg/Vector3", {"x": None}, "Vector3.x: expected float, got None"),
    ("geometry_msgs/msg/Vector3", {"x": True}, "Vector3.x: expected float, got bool"),
    ("geometry_msgs/msg/Vector3", {"x": 10**400}, "Vector3.x: int does not fit into a float64"),
    ("geometry_msgs/msg/Vector3", [1.0], "Vector3: expected a mapping, got list"),
    ("geometry_msgs/msg/Vector3", None, "Vector3: expected a mapping, got None"),
    ("std_msgs/msg/Float32", {"data": 1e39}, "Float32.data: 1e+39 does not fit into a float32"),
    ("std_msgs/msg/Int8", {"data": 200}, "Int8.data: expected an integer in [-128, 127], got 200"),
    ("std_msgs/msg/Int8", {"data": True}, "Int8.data: expected int, got bool"),
    ("std_msgs/msg/Int8", {"data": 1.0}, "Int8.data: expected int, got float"),
    ("std_msgs/msg/Bool", {"data": 1}, "Bool.data: expected bool, got int"),
    ("std_msgs/msg/Byte", {"data": 256}, "Byte.data: expected an integer in [0, 255], got 256"),
    ("std_msgs/msg/Byte", {"data": "ab"}, "Byte.data: expected bytes of length 1, got str"),
    ("std_msgs/msg/String", {"data": 1}, "String.data: expected str, got int"),
    ("std_msgs/msg/String", {"data": "\0"}, "String.data: NUL at character 0"),
    ("geometry_msgs/msg/Twist", {"linear": {"x": "a"}}, "Twist.linear.x: expected float, got str"),
    ("geometry_msgs/msg/Twist", {"linear": 1}, "Twist.linear: expected a mapping, got int"),
    (
        "sensor_msgs/msg/JointState",
        {"position": [0.0, "a"]},
        "JointState.position[1]: expected float, got str",
    ),
    ("sensor_msgs/msg/JointState", {"position": "ab"}, "JointState.position: expected a list, got str"),
    ("sensor_msgs/msg/JointState", {"name": ["a", 1]}, "JointState.name[1]: expected str, got int"),
    (
        "nav_msgs/msg/Path",
        {"poses": [{}, {"pose": {"orientation": {"q": 1}}}]},
        "poses[1].pose.orientation.q: no such",
    ),
    ("codec_msgs/msg/Letter", {"a": "ab"}, "Letter.a: expected str of length 1, got length 2"),
    ("codec_msgs/msg/Letter", {"a": 5}, "Letter.a: expected str of length 1, got int"),
    ("codec_msgs/msg/Letter", {"a": True}, "Letter.a: expected str of length 1, got bool"),
    ("codec_msgs/msg/Arrays", {"flags": [True]}, "Arrays.flags: expected 3 elements, got 1"),
    ("codec_msgs/msg/Arrays", {"floats": [1.0, 2.0]}, "Arrays.floats: expected 3 elements, got 2"),
    ("codec_msgs/msg/Bounds", {"texts": ["abcd"]}, "Bounds.texts[0]: expected at most 3 characters, got 4"),
    ("codec_msgs/msg/Bounds", {"octets": [1, 2, 3]}, "Bounds.octets: expected at most 2 elements, got 3"),
    (
        "codec_msgs/msg/Sequences",
        {"uint8s": [1, 300]},
        "Sequences.uint8s[1]: expected an integer in [0, 255], got 300",
    ),
]


@pytest.mark.parametrize(("name", "document", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_refused(classes: Classes, name: str, document: Any, text: str) -> None:
    with pytest.raises(ConversionError) as caught:
        from_dict(classes[name], document)
    assert text in str(caught.value)


def test_broken_texts_and_messages(classes: Classes) -> None:
    vector = classes["geometry_msgs/msg/Vector3"]
    with pytest.raises(ConversionError, match=r"^Vector3: not YAML: .*line 1, column 4"):
        from_yaml(vector, "x: [1")
    with pytest.raises(ConversionError, match=r"^Vector3: not JSON: Expecting .*line 1 column 6"):
        from_json(vector, '{"x":')
    message = vector()
    message._y = "a"
    with pytest.raises(ConversionError, match=r"^Vector3.y: expected float, got str$"):
        to_dict(message)
    with pytest.raises(ConversionError, match=r"^int: expected a message, got int$"):
        to_json(3)


def test_arguments_in_the_wrong_order(classes: Classes) -> None:
    """`deserialize` takes the class last, the others first: the error says so if they are mixed up."""
    vector = classes["geometry_msgs/msg/Vector3"]
    with pytest.raises(TypeError, match=r"^deserialize\(\) takes the bytes first, and the class second$"):
        deserialize(vector, serialize(vector()))  # type: ignore[type-var, arg-type]
    for convert, argument, what in (
        (from_dict, {}, "mapping"),
        (from_yaml, "", "text"),
        (from_json, "{}", "text"),
    ):
        with pytest.raises(TypeError, match=rf"takes the class first, and the {what} second$"):
            convert(argument, vector)  # type: ignore[operator]


def test_messages_of_another_type_are_named_in_full(classes: Classes) -> None:
    twist, point = classes["geometry_msgs/msg/Twist"], classes["geometry_msgs/msg/Point"]
    said = r"^Twist.linear: expected geometry_msgs/msg/Vector3, got geometry_msgs/msg/Point$"
    for refuse in (serialize, to_dict):
        with pytest.raises(ValueError, match=said):
            refuse(twist(linear=point()))


def test_a_blob_is_converted_at_once(classes: Classes) -> None:
    """A megabyte of integers takes milliseconds, not one function call per integer."""
    image = classes["sensor_msgs/msg/Image"](data=array("B", bytes(1_000_000)))
    assert from_dict(type(image), to_dict(image)) == image
