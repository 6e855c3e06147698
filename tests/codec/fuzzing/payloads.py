"""Broken payloads, made from good ones."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from struct import pack_into
from typing import TypeAlias

Mutation: TypeAlias = Callable[[Random, bytearray, bytes], None]
"""Changes a payload; the other one, of the same class, is to take from."""

_COUNTS = (0, 1, 2, 3, 7, 255, 0xFFFF, 0xFFFFFF, 0x10000001, 0x40000000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
_HEADERS = (b"\0\0", b"\0\1", b"\0\2", b"\0\3", b"\0\7", b"\1\1", b"\xff\xff")


def mutated(rng: Random, payload: bytes, other: bytes) -> bytes:
    """The payload with none to four changes."""
    data = bytearray(payload)
    for _ in range(rng.choice((0, 1, 1, 1, 1, 2, 2, 3, 4))):
        rng.choice(_MUTATIONS)(rng, data, other)
    return bytes(data)


def _flip(rng: Random, data: bytearray, other: bytes) -> None:
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _byte(rng: Random, data: bytearray, other: bytes) -> None:
    if data:
        data[rng.randrange(len(data))] = rng.choice((0, 1, 2, 0x7F, 0x80, 0xC3, 0xED, 0xF5, 0xFF))


def _cut(rng: Random, data: bytearray, other: bytes) -> None:
    del data[rng.randrange(len(data) + 1) :]


def _cut_little(rng: Random, data: bytearray, other: bytes) -> None:
    del data[max(len(data) - rng.randrange(1, 10), 0) :]


def _extend(rng: Random, data: bytearray, other: bytes) -> None:
    data += rng.randbytes(rng.randrange(1, 20))


def _count(rng: Random, data: bytearray, other: bytes) -> None:
    if len(data) >= 8:
        value = rng.choice(_COUNTS) if rng.random() < 0.7 else len(data) + rng.randrange(-9, 9)
        order = "<I" if data[1] & 1 or rng.random() < 0.2 else ">I"
        pack_into(order, data, rng.randrange(1, len(data) // 4) * 4, value & 0xFFFFFFFF)


def _splice(rng: Random, data: bytearray, other: bytes) -> None:
    if other and data:
        begin = rng.randrange(len(other)) & -4
        place = rng.randrange(len(data)) & -4
        size = rng.randrange(1, 33)
        data[place : place + (size if rng.random() < 0.7 else 0)] = other[begin : begin + size]


def _remove(rng: Random, data: bytearray, other: bytes) -> None:
    if data:
        place = rng.randrange(len(data))
        del data[place : place + rng.randrange(1, 9)]


def _header(rng: Random, data: bytearray, other: bytes) -> None:
    data[:2] = rng.choice(_HEADERS)


def _noise(rng: Random, data: bytearray, other: bytes) -> None:
    data[4:] = rng.randbytes(rng.randrange(64))


_MUTATIONS: tuple[Mutation, ...] = (
    *(_flip, _flip, _byte, _byte, _cut, _cut_little, _extend),
    *(_count, _count, _count, _splice, _splice, _remove, _header, _noise),
)
