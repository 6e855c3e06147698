"""Every value that a message can hold survives a round trip on the fast path, with the bytes of its fields."""

from __future__ import annotations

import tracemalloc
from array import array
from typing import Any

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.codec.encoding import encode_any

from .big_endian import big_endian
from .strategies import messages
from .support import Classes, without_slow_path

# Nested loops and every kind of field: worth more examples than AddTwoInts.
CORNERS = ["Arrays", "Bounds", "Deep", "Letters", "Sequences", "Shifting", "Wide", "Words"]


@settings(max_examples=120)
@given(data=st.data())
@pytest.mark.parametrize("name", CORNERS)
def test_corners(classes: Classes, name: str, data: st.DataObject) -> None:
    check(data.draw(messages(classes[f"codec_msgs/msg/{name}"])))


@settings(max_examples=500)
@given(data=st.data())
def test_every_type(classes: Classes, data: st.DataObject) -> None:
    """Every type gets its turn at its default values; hypothesis then chooses among all of them."""
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    check(data.draw(messages(cls)))


def test_default_values(classes: Classes) -> None:
    assert len(classes) > 390
    for cls in classes.values():
        check(cls())


def check(message: Any) -> None:
    cls = type(message)
    with without_slow_path(cls):
        data = serialize(message)
        result = deserialize(data, cls)
        assert deserialize(data + b"what follows is ignored", cls) == message
    assert data == encode_any(message)
    assert result == decode_any(data, cls) == message
    assert deserialize(big_endian(message), cls) == message
    assert serialize(result) == data


def test_kinds_of_values(classes: Classes) -> None:
    """Decoding returns what rosidl's classes hold: array.array, numpy arrays that own their data, lists."""
    sequences, arrays = classes["codec_msgs/msg/Sequences"], classes["codec_msgs/msg/Arrays"]
    sent = sequences(
        doubles=[1.0], floats=[2.0], characters=[65], raw=[b"\x07"], flags=[True], texts=["a"], uint8s=[1]
    )
    data = serialize(sent)
    for kind in (bytes, bytearray, memoryview, lambda data: array("B", data)):
        result = deserialize(kind(data), sequences)
        assert result == sent
        assert isinstance(result.doubles, array) and result.floats.typecode == "f"
        assert (result.raw, result.flags, result.texts) == ([b"\x07"], [True], ["a"])
    for data in (serialize(arrays(floats=[1.0, 2.0, 3.0])), big_endian(arrays(floats=[1.0, 2.0, 3.0]))):
        writable = bytearray(data)
        fixed = deserialize(writable, arrays)
        assert fixed.floats.dtype == numpy.float32 and fixed.floats.flags.aligned
        assert fixed.large.dtype == numpy.float64 and fixed.large.size == 100
        fixed.floats[0] = 9.0
        writable[:] = bytes(len(writable))
        assert fixed.floats.tolist() == [9.0, 2.0, 3.0], "the message shares no memory with what it came from"


def test_remembered_strings_do_not_pile_up(classes: Classes) -> None:
    """More different strings than are remembered, and long ones, all survive a round trip."""
    cls = classes["codec_msgs/msg/Sequences"]
    for start in range(0, 10_000, 500):
        texts = [f"text {index}" for index in range(start, start + 500)] + [
            "é" * 1000,
            "",
            "x" * 63,
            "x" * 64,
        ]
        assert deserialize(serialize(cls(texts=texts)), cls).texts == texts


def test_remembered_sequences_are_copies(classes: Classes) -> None:
    cls = classes["codec_msgs/msg/Sequences"]
    data = serialize(cls(texts=["a", "b"]))
    deserialize(data, cls).texts.append("mine")
    first, second = deserialize(data, cls), deserialize(data, cls)
    assert first.texts == second.texts == ["a", "b"] and first.texts is not second.texts
    # The same beginning, another end or count.
    for texts in (["a", "c"], ["a"], ["a", "b", "c"], ["a", "b"]):
        assert deserialize(serialize(cls(texts=texts)), cls).texts == texts


def test_one_copy_of_a_blob(classes: Classes) -> None:
    """A megabyte of pixels is copied once each way: into the bytes, and out of them."""
    image = classes["sensor_msgs/msg/Image"]
    message, size = image(data=array("B", bytes(1_000_000))), 1_000_000
    data = serialize(message)
    for function in (lambda: serialize(message), lambda: deserialize(data, image)):
        function()
        tracemalloc.start()
        try:
            result = function()
            assert size < tracemalloc.get_traced_memory()[1] < 1.2 * size
        finally:
            tracemalloc.stop()
        del result
