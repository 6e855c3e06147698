"""Checksums in C are those of zlib."""

from __future__ import annotations

import random
import zlib
from array import array

import pytest
from ifgen_runtime.bag.mcap.records import crc32
from ifgen_runtime.codec.choice import chosen

native = pytest.mark.skipif(
    not hasattr(chosen().extension, "crc32"),
    reason="ifgen-ros-native is missing, or this processor's instruction",
)


@native
def test_all_lengths_and_places() -> None:
    """Lanes of 16 bytes, four at once: around each of their ends, and at any address."""
    chance = random.Random(16)
    of = chosen().extension.crc32
    data = chance.randbytes(3000)
    for size in [*range(400), *range(980, 1050), 2900]:
        for start in range(0, 17, 5):
            piece, before = memoryview(data)[start : start + size], chance.getrandbits(32)
            assert of(piece) == zlib.crc32(piece), size
            assert of(piece, before) == zlib.crc32(piece, before), size


@native
@pytest.mark.parametrize("size", [2**16 - 1, 2**16, 2**20 + 7])
def test_large_data_in_pieces(size: int) -> None:
    data = random.Random(size).randbytes(size)
    of = chosen().extension.crc32
    assert of(data) == zlib.crc32(data) == of(data[size // 3 :], of(data[: size // 3]))
    assert of(bytes(size)) == zlib.crc32(bytes(size))
    assert of(b"\xff" * size) == zlib.crc32(b"\xff" * size)


@native
def test_what_is_no_data() -> None:
    of = chosen().extension.crc32
    assert of(array("d", [0.1, 0.2])) == zlib.crc32(array("d", [0.1, 0.2]))
    assert of(bytearray(b"walk")) == zlib.crc32(b"walk")
    with pytest.raises(TypeError):
        of("walk")
    with pytest.raises(BufferError):
        of(memoryview(bytes(100))[::2])
    with pytest.raises(TypeError):
        of()


def test_the_one_that_runs() -> None:
    assert crc32(b"123456789") == 0xCBF43926
    assert crc32(memoryview(b"56789"), crc32(b"1234")) == 0xCBF43926
