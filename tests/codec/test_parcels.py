"""A message for one reader in this process: its large arrays are copied once, and the reader's message gets them."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import Any

import numpy
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen_runtime import SerializationError, deserialize, serialize
from ifgen_runtime.codec.choice import chosen, packer
from ifgen_runtime.views import decoders

from .strategies import messages
from .support import Classes
from .test_native import shape

NATIVE: Any = chosen().extension
pytestmark = pytest.mark.skipif(NATIVE is None, reason=f"the codec in C does not run: {chosen().reason}")
LARGE = bytes(range(256)) * 20


@pytest.fixture
def every_array() -> Iterator[None]:
    """Every array with an element is large enough."""
    before = NATIVE.codec_large_in_parcels(0)
    yield
    NATIVE.codec_large_in_parcels(before)


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
@pytest.mark.parametrize("name", ["Sequences", "Arrays", "Bounds", "Shifting", "Deep"])
def test_it_arrives_as_over_bytes(classes: Classes, every_array: None, name: str, data: Any) -> None:
    cls = classes[f"codec_msgs/msg/{name}"]
    message = data.draw(messages(cls))
    whole = serialize(message)
    parcel = packer(cls)(message)
    assert bytes(parcel) == whole
    assert shape(cls.__deserialize__(parcel)) == shape(deserialize(whole, cls))


def test_arrays_of_every_type_in_messages_of_messages(classes: Classes, every_array: None) -> None:
    cls = classes["codec_msgs/msg/Sequences"]
    message = cls(uint8s=[1], int16s=[-2, 3], uint32s=[4], int64s=[-5], floats=[0.1, 0.2, 0.3], doubles=[0.1])
    parcel = packer(cls)(message)
    assert type(parcel).__name__ == "Parcel"
    arrived = cls.__deserialize__(parcel)
    assert shape(arrived) == shape(message)
    assert arrived.doubles is not message.doubles


def image(classes: Classes) -> Any:
    return classes["sensor_msgs/msg/Image"](encoding="mono8", step=len(LARGE), data=LARGE)


def test_neither_side_sees_what_the_other_writes(classes: Classes) -> None:
    message = image(classes)
    parcel = packer(type(message))(message)
    message.data[0] = 99
    arrived = type(message).__deserialize__(parcel)
    arrived.data[1] = 98
    assert bytes(arrived.data[:3]) == bytes([0, 98, 2])
    assert bytes(message.data[:3]) == bytes([99, 1, 2])


def test_it_can_be_read_once(classes: Classes) -> None:
    """Else two messages would have one array."""
    message = image(classes)
    parcel = packer(type(message))(message)
    type(message).__deserialize__(parcel)
    for read in (bytes, type(message).__deserialize__, decoders[type(message)]):
        with pytest.raises(RuntimeError, match="handed over"):
            read(parcel)


def test_views_and_other_classes_read_bytes_of_it(classes: Classes) -> None:
    message, other = image(classes), classes["sensor_msgs/msg/CompressedImage"]
    pack = packer(type(message))
    viewed = decoders[type(message)](pack(message))
    assert isinstance(viewed.data, numpy.ndarray) and viewed.data.tobytes() == LARGE
    assert bytes(pack(message)) == serialize(message)
    serialize(other())  # it has its codec now
    assert shape(other.__deserialize__(pack(message))) == shape(deserialize(serialize(message), other))


def test_small_ones_are_bytes(classes: Classes) -> None:
    cls = classes["sensor_msgs/msg/Image"]
    assert type(packer(cls)(cls(data=bytes(4096)))) is bytes
    assert type(packer(cls)(cls(data=bytes(4097)))) is not bytes


def test_what_cannot_be_sent_is_refused_in_the_same_words(classes: Classes) -> None:
    cls = classes["sensor_msgs/msg/Image"]
    message = cls(data=LARGE)
    message._data = array("b", LARGE[:100])
    with pytest.raises(SerializationError) as refused:
        packer(cls)(message)
    with pytest.raises(SerializationError) as expected:
        serialize(message)
    assert str(refused.value) == str(expected.value) != ""


def test_derived_classes_are_written_as_always(classes: Classes) -> None:
    cls = classes["sensor_msgs/msg/Image"]

    class Mine(cls):  # type: ignore[misc, valid-type]  # a class at run time
        pass

    for message in (Mine(data=LARGE), cls(data=LARGE, check_fields=True)):
        assert bytes(packer(cls)(message)) == serialize(message)
    with pytest.raises(TypeError, match="__serialize__"):
        packer(cls)(5)


def test_parcels_are_not_made_by_users(classes: Classes) -> None:
    message = image(classes)
    cls = type(packer(type(message))(message))
    with pytest.raises(TypeError, match="cannot create"):
        cls()
    with pytest.raises(TypeError, match="immutable"):
        cls.__bytes__ = None
