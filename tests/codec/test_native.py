"""The codec in C says what the generated functions say, and does the work itself where they need no slow path."""

from __future__ import annotations

import random
from array import array
from collections.abc import Callable
from typing import Any

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec.choice import chosen

from .strategies import messages
from .support import Classes

NATIVE: Any = chosen().extension
pytestmark = pytest.mark.skipif(NATIVE is None, reason=f"the codec in C does not run: {chosen().reason}")

CORNERS = ["Arrays", "Bounds", "Deep", "Letters", "Sequences", "Shifting", "Wide", "Words"]


def in_c(function: Callable[..., Any], *arguments: Any) -> Any:
    """The result of a call that C must not leave to Python."""
    before = NATIVE.codec_counts()
    result = function(*arguments)
    after = NATIVE.codec_counts()
    assert after[2] == before[2] and sum(after) == sum(before) + 1, "C left it to Python"
    return result


def python(cls: type[Any]) -> tuple[Callable[[Any], bytes], Callable[[bytes], Any]]:
    """The generated functions of a class."""
    encode, decode, _ = vars(cls)["__codec__"]
    return encode, decode


def shape(value: Any) -> Any:
    """A value with the types of everything in it, to be compared: 1 is not True, an array.array no list."""
    if hasattr(value, "_fields_and_field_types"):
        names = type(value).__slots__
        return type(value), [shape(getattr(value, name)) for name in names if name != "_check_fields"]
    if isinstance(value, list):
        return list, [shape(item) for item in value]
    if isinstance(value, array):
        return array, value.typecode, value.tobytes()
    if isinstance(value, numpy.ndarray):
        flags = value.flags
        return value.dtype, value.shape, value.tobytes(), flags.writeable, flags.c_contiguous
    return type(value), repr(value)


def check(message: Any) -> None:
    """Both codecs write the same bytes, and read the same message from them."""
    cls = type(message)
    encode, decode = python(cls)
    serialize(message)  # attaches the class and loads numpy
    data = in_c(serialize, message)
    assert data == encode(message) == in_c(message.__serialize__)
    expected = shape(decode(data))
    assert shape(in_c(deserialize, data, cls)) == shape(in_c(cls.__deserialize__, data)) == expected
    assert shape(in_c(deserialize, data + b"what follows", cls)) == expected


def test_every_class_runs_in_c(classes: Classes) -> None:
    for cls in classes.values():
        check(cls())
    assert chosen().refused.keys().isdisjoint(classes.values())


@settings(max_examples=80)
@given(data=st.data())
@pytest.mark.parametrize("name", CORNERS)
def test_corners(classes: Classes, name: str, data: st.DataObject) -> None:
    check(data.draw(messages(classes[f"codec_msgs/msg/{name}"])))


@settings(max_examples=250)
@given(data=st.data())
def test_every_type(classes: Classes, data: st.DataObject) -> None:
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    check(data.draw(messages(cls)))


def verdict(function: Callable[..., Any], *arguments: Any) -> Any:
    """What a call returns, or its error in words."""
    try:
        return shape(function(*arguments))
    except Exception as error:
        return type(error), str(error)


@settings(max_examples=100)
@given(data=st.data())
@pytest.mark.parametrize("name", CORNERS)
def test_the_same_verdict_on_broken_bytes(classes: Classes, name: str, data: st.DataObject) -> None:
    cls = classes[f"codec_msgs/msg/{name}"]
    whole = bytearray(serialize(data.draw(messages(cls))))
    chance = random.Random(data.draw(st.integers(0, 2**32)))
    _, decode = python(cls)
    for _ in range(10):
        broken = whole[:]
        for _ in range(chance.randrange(3)):
            at = chance.randrange(len(broken))
            broken[at] = chance.choice((0, 1, 0x7F, 0x80, 0xFF, broken[at] ^ 1 << chance.randrange(8)))
        cut = bytes(broken[: chance.randrange(len(broken) + 1)] if chance.random() < 0.5 else broken)
        assert verdict(deserialize, cut, cls) == verdict(decode, cut)


WRONG: list[Any] = [
    None, 1, 1.5, True, 2**70, -1, 1e300, "x", "é\0", "\ud800", b"x", b"xy", [], [None], [1.5], ["x", 1], (),
    ("x",), array("d", [1.0]), array("B", b"x"), numpy.zeros(3), numpy.zeros((3, 1), "float32")[::2],
    numpy.float64(0.1), numpy.int32(7), object(), type("Text", (str,), {})("x"), type("List", (list,), {})(),
    "x" * 1000, [""] * 1000, [True, False, None], numpy.zeros(9, ">f8"),
]  # fmt: skip


@pytest.mark.parametrize("name", CORNERS)
def test_the_same_verdict_on_wrong_values(classes: Classes, name: str) -> None:
    """Whatever a slot holds, and where it holds nothing at all."""
    cls = classes[f"codec_msgs/msg/{name}"]
    encode, _ = python(cls)
    for slot in [name for name in cls.__slots__ if name != "_check_fields"]:
        for wrong in WRONG:
            message = cls()
            setattr(message, slot, wrong)
            assert verdict(serialize, message) == verdict(encode, message), (slot, wrong)
        message = cls()
        delattr(message, slot)
        error, text = verdict(serialize, message)
        assert (error, text) == verdict(encode, message) and "has no value" in text


def test_derived_and_checked_messages_go_the_python_way(classes: Classes) -> None:
    twist = classes["geometry_msgs/msg/Twist"]

    class Mine(twist):  # type: ignore[misc, valid-type]
        pass

    expected = serialize(twist())
    for message in (Mine(), twist(check_fields=True)):
        assert serialize(message) == message.__serialize__() == expected
    inside = twist()
    inside.linear = type("Derived", (type(inside.linear),), {})()
    assert serialize(inside) == expected
    assert type(Mine.__deserialize__(expected)) is twist
    assert deserialize(bytearray(expected), twist) == deserialize(data=expected, cls=twist) == twist()
