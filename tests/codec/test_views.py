"""Messages whose numeric sequences stay in the bytes that they came in: `deserialize(..., views=True)`."""

from __future__ import annotations

import copy
import operator
import pickle
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import DeserializationError, deserialize, from_dict, serialize, to_dict
from ifgen_runtime.codec.choice import chosen
from ifgen_runtime.field_types import Basic, Field, fields_of
from ifgen_runtime.views import SequenceView

from .big_endian import big_endian
from .strategies import messages
from .support import Classes, without_slow_path


def sequences(message: Any) -> Iterator[tuple[Field, Any]]:
    """The numeric sequences of a message and of those that it holds."""
    for field in fields_of(message.__class__):
        value = getattr(message, field.slot)
        if isinstance(field.type, Basic):
            if field.is_sequence and field.type.typecode:
                yield field, value
        elif isinstance(field.type, type):
            for each in value if field.is_collection else [value]:
                yield from sequences(each)


@settings(max_examples=300)
@given(data=st.data())
def test_a_message_with_views_is_a_message(classes: Classes, data: st.DataObject) -> None:
    message = data.draw(messages(classes[data.draw(st.sampled_from(sorted(classes)))]))
    cls = type(message)
    payload = serialize(message)
    viewing = deserialize(payload, cls, views=True)
    assert viewing == message
    assert message == viewing
    assert repr(viewing) == repr(message)
    assert to_dict(viewing) == to_dict(message)
    assert serialize(viewing) == payload
    assert copy.deepcopy(viewing) == message
    for field, value in sequences(viewing):
        assert type(value) is SequenceView
        assert value.dtype == field.type.dtype
        assert value.base is payload
        assert not value.flags.writeable
    for field, value in sequences(message):
        assert type(value) is not SequenceView, field


@settings(max_examples=200)
@given(data=st.data())
def test_the_dtype_has_the_byte_order_of_the_payload(classes: Classes, data: st.DataObject) -> None:
    message = data.draw(messages(classes[data.draw(st.sampled_from(sorted(classes)))]))
    payload = big_endian(message)
    viewing = deserialize(payload, type(message), views=True)
    assert viewing == message
    assert message == viewing
    assert repr(viewing) == repr(message)
    assert to_dict(viewing) == to_dict(message)
    assert serialize(viewing) == serialize(message)
    for field, value in sequences(viewing):
        assert type(value) is SequenceView
        assert value.dtype == np.dtype(field.type.dtype).newbyteorder(">")
        assert value.base is payload


def test_generated_functions_make_the_views(classes: Classes) -> None:
    """The slow decoder is only for unexpected bytes, and for messages that hold large ones."""
    slow = {"test_msgs/msg/MultiNested"}
    for name, cls in classes.items():
        payload = serialize(cls())
        if name not in slow:
            with without_slow_path(cls):
                viewing = deserialize(payload, cls, views=True)
                serialize(viewing)


def test_c_makes_the_views(classes: Classes) -> None:
    """Of all messages, large ones too; bytes that C leaves to Python end as without C."""
    extension = chosen().extension
    if extension is None:
        pytest.skip(f"the codec runs in Python: {chosen().reason}")
    cls = classes["test_msgs/msg/MultiNested"]
    payload = serialize(cls())
    deserialize(payload, cls, views=True)  # imports numpy
    _, read, left = extension.codec_counts()
    viewing = deserialize(payload, cls, views=True)
    assert extension.codec_counts()[1:] == (read + 1, left)
    assert viewing == cls()
    assert all(value.base is payload for _, value in sequences(viewing))
    references = sys.getrefcount(payload)
    viewing = None
    assert sys.getrefcount(payload) < references
    with pytest.raises(DeserializationError):
        deserialize(payload[:-1], cls, views=True)
    assert extension.codec_counts()[1:] == (read + 1, left + 1)


def test_unequal_views(classes: Classes) -> None:
    cls = classes["codec_msgs/msg/Sequences"]
    payload = serialize(cls(uint8s=[1, 2, 3], doubles=[0.1, 0.2]))
    viewing = deserialize(payload, cls, views=True)
    for other in (cls(uint8s=[1, 2], doubles=[0.1, 0.2]), cls(uint8s=[1, 2, 3], doubles=[0.1, 0.3]), cls()):
        assert viewing != other
        assert other != viewing
        assert viewing != deserialize(serialize(other), cls, views=True)


@pytest.fixture
def payload(classes: Classes) -> bytes:
    """A message with three doubles, and many bytes."""
    cls = classes["codec_msgs/msg/Sequences"]
    return serialize(cls(uint8s=bytes(range(200)) * 20, doubles=[0.1, 0.2, 0.3]))


@pytest.fixture
def message(classes: Classes, payload: bytes) -> Any:
    """The same, with views."""
    return deserialize(payload, classes["codec_msgs/msg/Sequences"], views=True)


def test_writing_to_one_copies_it(classes: Classes, message: Any, payload: bytes) -> None:
    before = bytes(bytearray(payload))
    view = message.doubles
    message.doubles[1] = 7.5
    message.doubles[2:] = [8.5]
    assert message.doubles is view
    assert view.flags.writeable and view.flags.owndata
    assert view.tolist() == [0.1, 7.5, 8.5]
    assert payload == before
    assert not message.uint8s.flags.writeable
    message.uint8s[0] = 9
    message.uint8s[1] = 9
    assert message.uint8s.tolist()[:3] == [9, 9, 2]
    assert payload == before
    again = deserialize(serialize(message), type(message))
    assert again.doubles.tolist() == [0.1, 7.5, 8.5]


@pytest.mark.parametrize("field", ["uint8s", "doubles", "int32s"])
def test_operators_and_methods_that_write(message: Any, payload: bytes, field: str) -> None:
    """They act on the view itself; int32s is empty."""
    before = bytes(bytearray(payload))
    view, numbers = getattr(message, field), np.array(getattr(message, field))
    kept = view
    view += 1
    view *= 2
    assert view is kept
    assert np.array_equal(view, (numbers + 1) * 2)
    view.fill(3)
    view.sort()
    assert set(view.tolist()) <= {3}
    assert payload == before


def test_arrays_derived_from_one_are_read_only(message: Any) -> None:
    for derived in (message.doubles[1:], message.doubles.reshape(3, 1), message.doubles.view(np.uint64)):
        with pytest.raises(ValueError, match="read-only"):
            derived[0] = 1
        with pytest.raises(ValueError, match="read-only"):
            operator.iadd(derived, 1)
    with pytest.raises(ValueError, match="read-only"):
        np.add(message.doubles, 1, out=message.doubles)
    with pytest.raises(ValueError, match="WRITEABLE"):
        message.doubles.setflags(write=True)


def test_results_of_calculations_are_plain(message: Any) -> None:
    view = message.doubles
    for result in (view * 2, -view, np.sqrt(view), view == 0.1, view.cumsum(), np.asarray(view)):
        assert type(result) is np.ndarray
    for result in (view.sum(), view.max(), view[0], np.mean(view)):
        assert type(result) is np.float64


def test_derived_arrays_keep_the_bytes_that_they_show(message: Any, payload: bytes) -> None:
    """Also after the field has got memory of its own."""
    part, plain = message.uint8s[10:], np.asarray(message.uint8s)
    message.uint8s[:] = 0
    assert part.base._received is payload
    assert part[:3].tolist() == [10, 11, 12]
    assert plain[:3].tolist() == [0, 1, 2]
    changed = message.uint8s[10:]
    changed[0] = 5  # the memory is the message's now
    assert message.uint8s[10] == 5


def test_copies_and_pickles_own_their_memory(message: Any, payload: bytes) -> None:
    other = copy.deepcopy(message)
    assert other == message
    for _, value in sequences(other):
        assert not np.shares_memory(value, np.frombuffer(payload, np.uint8))
        for copied in (value, copy.copy(value), pickle.loads(pickle.dumps(value))):
            assert type(copied) is SequenceView
            assert copied.flags.writeable
            assert np.array_equal(copied, value)
    other.doubles[0] = 5.5
    assert other != message
    assert copy.copy(message).doubles is message.doubles


def test_fields_take_views(classes: Classes, message: Any) -> None:
    """Setters, constructors and conversions copy a view, as they copy any array."""
    cls = classes["codec_msgs/msg/Sequences"]
    other = cls(doubles=message.doubles)
    other.uint8s = message.uint8s
    assert other == message
    other.doubles[0] = 5.5
    assert message.doubles[0] == 0.1
    assert from_dict(cls, {"doubles": message.doubles, "uint8s": message.uint8s}) == message


def test_other_buffers_are_copied_first(classes: Classes, payload: bytes) -> None:
    """Somebody else could write to them."""
    data = bytearray(payload)
    message = deserialize(data, classes["codec_msgs/msg/Sequences"], views=True)
    data[:] = bytes(len(data))
    assert message.doubles.tolist() == [0.1, 0.2, 0.3]


def test_no_message_class() -> None:
    with pytest.raises(TypeError, match="is not a message class"):
        deserialize(b"\0\1\0\0", int, views=True)
    with pytest.raises(TypeError, match="the bytes first, and the class second"):
        deserialize(int, b"\0\1\0\0", views=True)  # type: ignore[type-var]
