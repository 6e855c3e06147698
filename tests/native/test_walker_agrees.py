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
from ifgen_runtime.decoding import decode_any  # noqa: E402
from ifgen_runtime.type_description import describe  # noqa: E402
from ifgen_runtime.type_support import layout  # noqa: E402
from ifgen_runtime.type_support.descriptions import Description  # noqa: E402
from ifgen_runtime.type_support.layout import layout_program  # noqa: E402
from ifgen_runtime.type_support.register import _decoder  # noqa: E402

from ..codec.big_endian import big_endian  # noqa: E402
from ..codec.strategies import messages  # noqa: E402
from ..codec.support import Classes, generate  # noqa: E402

WORDS = [0, 1, 2, 3, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 0x40000000, 0x10000001, 0xD800, 0xDC00, 0x10000]


@pytest.fixture(scope="module")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Classes:
    return generate(tmp_path_factory.mktemp("generated"))


@cache
def program(cls: type[Any]) -> bytes:
    return layout_program(Description(describe(cls)))


def judge(payload: bytes, cls: type[Any]) -> bool:
    """Whether the C code accepts a payload; Python's reading of it must agree."""
    accepted = bool(native.accepts(program(cls), payload))
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


@settings(max_examples=1500)
@given(data=st.data())
def test_on_messages_and_what_becomes_of_them_on_the_way(classes: Classes, data: st.DataObject) -> None:
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
    assert native.accepts(program(cls), over)
    assert _decoder(cls)(over).text == "abcdef"
    with pytest.raises(DeserializationError):
        decode_any(over, cls)


def test_nested_messages_as_parts_of_the_program(classes: Classes, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each type is described once, however often and deep it is nested, and means the same."""
    monkeypatch.setattr(layout, "_MOST_INLINED", 0)
    for cls in classes.values():
        words = layout_program(Description(describe(cls)))
        for payload in (serialize(cls()), big_endian(cls())):
            assert native.accepts(words, payload), cls
            for length in range(0, len(payload), 1 + len(payload) // 10):
                assert not native.accepts(words, payload[:length]), (cls, length)


def test_programs_do_not_grow_with_the_depth(tmp_path: Path) -> None:
    """Forty levels of two fields each, whose messages nobody could store."""
    levels = {f"Level{n}": f"Level{n - 1} a\nint8 b\nLevel{n - 1}[] c\n" for n in range(1, 40)}
    folder = tmp_path / "in" / "deep_msgs" / "msg"
    folder.mkdir(parents=True)
    for name, text in ({"Level0": "float64 a\nstring b\n"} | levels).items():
        (folder / f"{name}.msg").write_text(text)
    deep = generate(tmp_path / "out", tmp_path / "in")
    program = layout_program(Description(describe(deep["deep_msgs/msg/Level39"])))
    assert len(program) < 40 * 4 * 60
    payload = serialize(deep["deep_msgs/msg/Level39"]())
    assert native.accepts(program, payload)
    assert not native.accepts(program, payload[:-1])


@pytest.mark.parametrize("words", [[], [9], [1, 3, 1], [1, 8], [5, 1, 2, 1], [5, 1, 0], [5, 1, 9, 2], [7, 0]])
def test_malformed_programs_are_refused(words: list[int]) -> None:
    data = struct.pack(f"={len(words)}I", *words)
    if not words:
        assert native.accepts(data, b"\0\1\0\0")
        return
    with pytest.raises(ValueError, match="the layout program is malformed"):
        native.accepts(data, b"\0\1\0\0")
