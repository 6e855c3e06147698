"""The C code that checks payloads and the Python code that reads them agree on what a message is.

If the C code accepted what Python refuses, a peer's bytes would end the spin of a node; if it refused what Python
reads, messages would be lost.
"""

from __future__ import annotations

import struct
from functools import cache
from pathlib import Path
from typing import Any

import pytest

native = pytest.importorskip("ifgen_native._native", reason="ifgen_native is not built: `make` does it")

from hypothesis import given, settings  # noqa: E402  # not needed where the extension is not
from hypothesis import strategies as st  # noqa: E402
from ifgen_runtime import DeserializationError, serialize  # noqa: E402
from ifgen_runtime.codec.decoding import decode_any  # noqa: E402
from ifgen_runtime.real_rclpy.layout import (  # noqa: E402
    Description,
    Layout,
    described_layout,
    layout_of,
)
from ifgen_runtime.real_rclpy.register import _decoder  # noqa: E402
from ifgen_runtime.type_description import describe  # noqa: E402

from ..codec.big_endian import big_endian  # noqa: E402
from ..codec.strategies import messages  # noqa: E402
from ..codec.support import Classes, folder_of_all, generate  # noqa: E402

WORDS = [0, 1, 2, 3, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 0x40000000, 0x10000001, 0xD800, 0xDC00, 0x10000]


@pytest.fixture(scope="module")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Classes:
    return generate(folder_of_all(tmp_path_factory))


@cache
def layout(cls: type[Any]) -> Layout:
    """From the tables of the codec."""
    return layout_of(cls, Description(describe(cls)))


@cache
def described(cls: type[Any]) -> Layout:
    """As for a class without table."""
    return described_layout(Description(describe(cls)))


def judge(payload: bytes, cls: type[Any]) -> bool:
    """Whether the C code accepts a payload; Python's reading of it must agree."""
    accepted = bool(native.accepts(layout(cls), payload))
    assert accepted == native.accepts(described(cls), payload), (cls, payload.hex())
    try:
        _decoder(cls)(payload)
        read = True
    except DeserializationError:
        read = False
    assert accepted == read, (cls, payload.hex())
    if not accepted:
        with pytest.raises(DeserializationError):
            cls.__deserialize__(payload)
    return accepted


@settings(max_examples=150)
@given(data=st.data())
def test_on_messages_and_what_becomes_of_them_on_the_way(classes: Classes, data: st.DataObject) -> None:
    judge_mutations(classes, data)


@pytest.mark.slow
@settings(max_examples=700)
@given(data=st.data())
def test_on_many_messages(classes: Classes, data: st.DataObject) -> None:
    judge_mutations(classes, data)


def judge_mutations(classes: Classes, data: st.DataObject) -> None:
    cls = classes[data.draw(st.sampled_from(sorted(classes)))]
    encode = data.draw(st.sampled_from([serialize, big_endian]))
    payload = bytearray(encode(data.draw(messages(cls))))
    assert judge(bytes(payload), cls)
    for _ in range(data.draw(st.integers(1, 4))):
        kind = data.draw(st.sampled_from(["cut", "extend", "flip", "word", "word"]))
        place = data.draw(st.integers(0, max(len(payload) - 1, 0)))
        if kind == "cut":
            del payload[place:]
        elif kind == "extend":
            payload += data.draw(st.binary(max_size=9))
        elif kind == "flip" and payload:
            payload[place] ^= 1 << data.draw(st.integers(0, 7))
        else:
            word = data.draw(st.sampled_from(WORDS))
            order = data.draw(st.sampled_from("<>"))
            payload[place & -4 : (place & -4) + 4] = struct.pack(f"{order}I", word)
        judge(bytes(payload), cls)


@settings(max_examples=1000)
@given(
    data=st.data(),
    body=st.binary(max_size=200) | st.integers(0, 200).map(bytes),
    header=st.sampled_from([b"\0\1\0\0", b"\0\0\0\0", b"\0\1\xff\3", b"\0\3\0\0", b"\1\0\0\0", b"\0\1", b""]),
)
def test_on_noise(classes: Classes, data: st.DataObject, body: bytes, header: bytes) -> None:
    judge(header + body, classes[data.draw(st.sampled_from(sorted(classes)))])


def test_on_every_cut_of_every_type(classes: Classes) -> None:
    for cls in classes.values():
        for payload in (serialize(cls()), big_endian(cls())):
            assert judge(payload, cls)
            for length in range(0, len(payload), 1 + len(payload) // 40):
                assert not judge(payload[:length], cls), (cls, length)


def test_what_is_over_its_bound_is_received_as_compiled_types_receive_it(classes: Classes) -> None:
    cls = classes["codec_msgs/msg/Bounds"]
    payload = serialize(cls())
    over = payload[:4] + b"\7\0\0\0abcdef\0\0" + payload[12:]
    assert native.accepts(layout(cls), over)
    assert _decoder(cls)(over).text == "abcdef"
    with pytest.raises(DeserializationError):
        decode_any(over, cls)


def test_layouts_do_not_grow_with_the_depth(tmp_path: Path) -> None:
    """Forty levels of two fields each, whose messages nobody could store."""
    levels = {f"Level{n}": f"Level{n - 1} a\nint8 b\nLevel{n - 1}[] c\n" for n in range(1, 40)}
    folder = tmp_path / "in" / "deep_msgs" / "msg"
    folder.mkdir(parents=True)
    for name, text in ({"Level0": "float64 a\nstring b\n"} | levels).items():
        (folder / f"{name}.msg").write_text(text)
    deep = generate(tmp_path / "out", tmp_path / "in")
    tables = described(deep["deep_msgs/msg/Level39"])
    assert len(tables) == 40 and sum(len(text) for text, _ in tables) < 40 * 60
    payload = serialize(deep["deep_msgs/msg/Level39"]())
    for either in (tables, layout(deep["deep_msgs/msg/Level39"])):
        assert native.accepts(either, payload)
        assert not native.accepts(either, payload[:-1])


def test_layouts_come_from_the_tables_of_codecs(classes: Classes) -> None:
    """Unless a class has none, or one that it calls."""
    for cls in classes.values():
        assert layout(cls)[-1][0] == vars(cls)["__codec__"][2][0]
    description = Description(describe(classes["codec_msgs/msg/Bounds"]))

    class Older:
        """From an ifgen without tables."""

    assert layout_of(Older, description) == described_layout(description)


CALL = "R1 E0._a.1.0 C1.0"


@pytest.mark.parametrize(
    "tables",
    [
        [],
        [""],
        ["X"],
        ["R1 d0._x R"],
        ["R2 d0._x"],
        ["SX0._x.0.0"],
        ["Sd1._x.0.0"],
        ["F0._a.1.0.0.0.2 T1._b.0"],
        [(CALL, 0)],  # itself
        [("R1 d0._x", 0), (CALL, 1)],
        [("R1 d0._x", 0), (CALL, 7)],
    ],
)
def test_malformed_layouts_are_refused(tables: list[Any]) -> None:
    pairs = [(table, 0) if isinstance(table, str) else table for table in tables]
    with pytest.raises(ValueError, match="the tables of the layout are malformed"):
        native.accepts(tuple((text, struct.pack("=I", call)) for text, call in pairs), b"\0\1\0\0")


def test_layouts_that_go_too_deep_are_refused() -> None:
    """They could overflow the stack of a thread of DDS."""
    tables = [("R1 Z", b"")] + [(CALL, struct.pack("=I", n)) for n in range(1025)]
    assert native.accepts(tuple(tables[:1025]), b"\0\1\0\0\0")
    with pytest.raises(ValueError, match="malformed"):
        native.accepts(tuple(tables), b"\0\1\0\0\0")
