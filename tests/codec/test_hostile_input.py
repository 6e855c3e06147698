"""Bytes that nobody should send lead at once to a DeserializationError or a message, and nothing else."""

from __future__ import annotations

import struct
import time
import tracemalloc
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen_runtime import DeserializationError, deserialize, serialize
from ifgen_runtime.codec.decoding import decode_any

from .big_endian import big_endian
from .strategies import messages
from .support import Classes

LITTLE, BIG = b"\0\1\0\0", b"\0\0\0\0"
HUGE = [0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 0x40000000, 0x10000001, 0x00FFFFFF]


def decoded(data: bytes, cls: type[Any]) -> Any:
    """The message or the error's text; all ways of decoding must agree."""
    try:
        fast = deserialize(data, cls)
    except DeserializationError as error:
        assert error.path.startswith(cls.__name__)
        with pytest.raises(DeserializationError):
            decode_any(data, cls)
        with pytest.raises(DeserializationError) as with_views:
            deserialize(data, cls, views=True)
        assert str(with_views.value) == str(error)
        return str(error)
    assert repr(fast) == repr(deserialize(data, cls, views=True))
    assert repr(fast) == repr(decode_any(data, cls))  # it can contain NaN, which repr shows
    return fast


@settings(max_examples=300)  # make fuzz tries millions
@given(data=st.data())
def test_mutations(classes: Classes, data: st.DataObject) -> None:
    """Good payloads of any type, cut, lengthened, with bytes flipped and words replaced."""
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    encode = data.draw(st.sampled_from([serialize, big_endian]))
    payload = bytearray(encode(data.draw(messages(cls))))
    for _ in range(data.draw(st.integers(1, 3))):
        kind = data.draw(st.sampled_from(["cut", "extend", "flip", "word"]))
        place = data.draw(st.integers(0, max(len(payload) - 1, 0)))
        if kind == "cut":
            del payload[place:]
        elif kind == "extend":
            payload += data.draw(st.binary(max_size=9))
        elif kind == "flip" and payload:
            payload[place] ^= 1 << data.draw(st.integers(0, 7))
        else:
            payload[place & -4 : (place & -4) + 4] = struct.pack("<I", data.draw(st.sampled_from(HUGE)))
    decoded(bytes(payload), cls)


@settings(max_examples=400)
@given(data=st.data(), body=st.binary(max_size=200), header=st.sampled_from([LITTLE, BIG, b"\0\7\0\0", b""]))
def test_noise(classes: Classes, data: st.DataObject, body: bytes, header: bytes) -> None:
    decoded(header + body, classes[data.draw(st.sampled_from(sorted(classes)))])


def test_every_cut_of_every_type(classes: Classes) -> None:
    """No proper beginning of the shortest message of a type is a message, in either byte order."""
    for cls in classes.values():
        for data in (serialize(cls()), big_endian(cls())):
            for length in range(0, len(data), 1 + len(data) // 40):
                assert isinstance(decoded(data[:length], cls), str), (cls, length)


SEQUENCE_TYPES = [
    "codec_msgs/msg/Deep",
    "codec_msgs/msg/Letters",
    "codec_msgs/msg/Sequences",
    "codec_msgs/msg/Shifting",
    "codec_msgs/msg/Wide",
    "codec_msgs/msg/Bounds",
    "nav_msgs/msg/Path",
    "sensor_msgs/msg/PointCloud2",
    "std_msgs/msg/String",
    "visualization_msgs/msg/Marker",
]


@pytest.mark.parametrize("name", SEQUENCE_TYPES)
@pytest.mark.parametrize("encode", [serialize, big_endian])
def test_huge_counts_cost_nothing(classes: Classes, name: str, encode: Any) -> None:
    """Each word of a payload in turn claims a gigantic count: this costs hardly any memory or time."""
    cls = classes[name]
    payload = encode(cls()) + bytes(64)
    order = "<" if encode is serialize else ">"
    decoded(payload, cls)
    tracemalloc.start()
    try:
        for place in range(4, len(payload) - 3, 4):
            for count in HUGE:
                started = time.process_time()
                tracemalloc.reset_peak()
                decoded(payload[:place] + struct.pack(f"{order}I", count) + payload[place + 4 :], cls)
                assert tracemalloc.get_traced_memory()[1] < 2_000_000, (place, count)
                assert time.process_time() - started < 1.0, (place, count)
    finally:
        tracemalloc.stop()


def test_empty_elements_are_counted_against_the_bytes_left(classes: Classes) -> None:
    """An empty message is a byte, so there cannot be more of them than bytes."""
    cls = classes["codec_msgs/msg/Deep"]
    data = serialize(cls())
    place = len(data) - 36  # after it come the two messages of `last`
    for count in (33, 2**32 - 1):
        broken = data[:place] + struct.pack("<I", count) + data[place + 4 :]
        expected = f"Deep.empties: truncated: {count} elements cannot be in the 32 bytes left"
        assert decoded(broken, cls) == expected


TEXTS = [
    (b"", "Pair: expected a header of 4 bytes, got 0 bytes"),
    (b"\0\1", "Pair: expected a header of 4 bytes, got 2 bytes"),
    (b"\0\7\0\0" + bytes(20), "Pair: expected plain CDR (header 0000 or 0001), got header 0007"),
    (b"\1\0\0\0" + bytes(20), "Pair: expected plain CDR (header 0000 or 0001), got header 0100"),
    (LITTLE, "Pair.key: truncated: 4 bytes needed at byte 4, 0 left"),
    (LITTLE + b"\5\0\0\0abc", "Pair.key: truncated: 5 bytes needed at byte 8, 3 left"),
    (BIG + b"\0\0\0\2a\0", "Pair.value: truncated: 4 bytes needed at byte 12, 0 left"),
]


@pytest.mark.parametrize(("data", "text"), TEXTS)
def test_errors_say_where(classes: Classes, data: bytes, text: str) -> None:
    assert decoded(data, classes["codec_msgs/msg/Pair"]) == text


def test_errors_lead_into_nested_messages(classes: Classes) -> None:
    path = classes["nav_msgs/msg/Path"]
    message = path(poses=[classes["geometry_msgs/msg/PoseStamped"]() for _ in range(3)])
    assert decoded(serialize(message)[:-8], path) == (
        "Path.poses[2].pose.orientation.w: truncated: 8 bytes needed at byte 236, 0 left"
    )
    wide = serialize(classes["codec_msgs/msg/Wide"](text="ab"))
    for unit, text in (
        (0xD800, "half of a surrogate pair at code unit 1"),
        (0x10000, "0x10000 is not a UTF-16"),
    ):
        broken = wide[:16] + struct.pack("<I", unit) + wide[20:]
        assert f"Wide.text: {text}" in decoded(broken, classes["codec_msgs/msg/Wide"])


OVER = [
    ("text", b"\7\0\0\0abcdef\0", "Bounds.text: expected at most 5 characters, got 6"),
    (
        "texts",
        b"\1\0\0\0\0\0\0\0\1\0\0\0\5\0\0\0abcd\0",
        "Bounds.texts[0]: expected at most 3 characters, got 4",
    ),
]


@pytest.mark.parametrize(("field", "body", "text"), OVER)
def test_over_bounds(classes: Classes, field: str, body: bytes, text: str) -> None:
    assert decoded(LITTLE + body + bytes(64), classes["codec_msgs/msg/Bounds"]) == text


def test_sequences_over_bounds(classes: Classes) -> None:
    """A bounded sequence one element over its bound, though all its elements are there."""
    cls = classes["codec_msgs/msg/Bounds"]
    data = serialize(cls(pairs=[classes["codec_msgs/msg/Pair"]()] * 2))
    broken = data[:-33] + b"\3" + data[-32:] + bytes(16)
    assert decoded(data + bytes(16), cls).pairs[1].key == ""
    assert decoded(broken, cls) == "Bounds.pairs: expected at most 2 elements, got 3"
    assert len(decode_any(broken, cls, bounded=False).pairs) == 3, (
        "for those who must take what compiled types take"
    )
