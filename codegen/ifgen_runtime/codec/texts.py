"""Strings on the wire: u32 length with the NUL, UTF-8, NUL; wstrings: u32 count, then UTF-16 units as u32.

Field names, frames and states come again and again, so the wire form of short strings is remembered, and of
the sequences that came last (joint names); what never repeats costs three times as much to write
(benchmarks/codec.py, column "cold").
"""

from __future__ import annotations

from itertools import repeat
from struct import Struct, pack, unpack

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    KeyT = TypeVar("KeyT", bytes, str)

_REMEMBERED = 4096
_LONGEST_REMEMBERED = 64
_REMEMBERED_SEQUENCES = 64
_LARGEST_REMEMBERED_SEQUENCE = 4096
_PREFIX = 32
_NOTHING: tuple[bytes, list[str]] = (b"", [])
_recently_read: dict[bytes, tuple[bytes, list[str]]] = {}  # by the first bytes
_recently_written: dict[str, tuple[bytes, list[str]]] = {}  # by the first string


class _WireForms(dict[str, bytes]):
    """String -> wire form, padded with zeros to a multiple of `alignment`.

    ValueError for a NUL in it or half of a surrogate pair; what is not a str raises something, too.
    """

    __slots__ = ("_alignment", "_packers")

    def __init__(self, alignment: int) -> None:
        self._alignment = alignment
        self._packers: list[Callable[[int, bytes], bytes]] = [
            Struct(f"<I{size + -size % alignment}s").pack for size in range(_LONGEST_REMEMBERED)
        ]

    def __missing__(self, text: str) -> bytes:
        encoded = text.encode()
        size = len(encoded) + 1
        if text.__class__ is not str or 0 in encoded:
            raise ValueError
        if size >= _LONGEST_REMEMBERED:
            return b"".join((size.to_bytes(4, "little"), encoded, bytes(1 + -size % self._alignment)))
        if len(self) >= _REMEMBERED:
            self.clear()
        form = self[text] = self._packers[size](size, encoded)
        return form


wire = _WireForms(1)
padded_wire = _WireForms(4)
_padded_form = padded_wire.__getitem__


def forget() -> None:
    """Forget all strings: for measurements of what it costs when none of them was seen before."""
    wire.clear()
    padded_wire.clear()
    _recently_read.clear()
    _recently_written.clear()


def padded_strings_wire(texts: list[str]) -> bytes:
    """The elements of a string sequence, the last one padded as well."""
    if not texts:
        return b""
    known, known_texts = _recently_written.get(texts[0], _NOTHING)
    if texts == known_texts:
        return known
    elements = b"".join(map(_padded_form, texts))
    _remember(_recently_written, texts[0], elements, texts)
    return elements


def strings_wire(texts: list[str]) -> bytes:
    """The elements of a string sequence, without padding after the last."""
    if not texts:
        return b""
    return b"".join((*map(_padded_form, texts[:-1]), wire[texts[-1]]))


def any_longer(texts: list[str], maximum: int) -> bool:
    """Whether one of the strings is over its bound."""
    return max(map(len, texts), default=0) > maximum


def strings(data: bytes, p: int, count: int, maximum: int | None) -> tuple[list[str], int]:
    """`count` strings from position `p` on, and the position after them."""
    start, key = p, data[p : p + _PREFIX]
    known, known_texts = _recently_read.get(key, _NOTHING)
    if len(known_texts) == count and data.startswith(known, p) and not p & 3 and maximum is None:
        return known_texts.copy(), p + len(known)
    texts: list[str] = []
    words = memoryview(data)[: len(data) & -4].cast("I")
    for _ in repeat(None, count):
        q = p + 7 & -4
        p = q + words[(q >> 2) - 1]
        text = data[q : p - 1].decode()
        if data[p - 1] or "\0" in text:
            raise ValueError
        texts.append(text)
    if maximum is not None and any_longer(texts, maximum):
        raise ValueError
    if count and not start & 3:
        _remember(_recently_read, key, data[start:p], texts)
    return texts, p


def _remember(
    memory: dict[KeyT, tuple[bytes, list[str]]], key: KeyT, elements: bytes, texts: list[str]
) -> None:
    """Remember a sequence, unless it is large."""
    if len(elements) < _LARGEST_REMEMBERED_SEQUENCE:
        if len(memory) >= _REMEMBERED_SEQUENCES:
            memory.clear()
        memory[key] = elements, texts.copy()


def wstring_wire(text: str) -> bytes:
    """The wire form of a wstring; an error for half of a surrogate pair, and for what is not a str."""
    if text.__class__ is not str:
        raise TypeError
    encoded = text.encode("utf-16-le")
    count = len(encoded) // 2
    return pack(f"<{count + 1}I", count, *unpack(f"<{count}H", encoded))


def wstrings_wire(texts: list[str]) -> bytes:
    """The elements of a wstring sequence."""
    return b"".join(map(wstring_wire, texts))


def wstring(data: bytes, p: int, maximum: int | None) -> tuple[str, int]:
    """A wstring from position `p` on, and the position after it."""
    from ifgen_runtime.codec.decoding import Reader  # few programs meet a wstring

    reader = Reader(data, "<", p)
    return reader.wide_text(maximum), reader.position


def wstrings(data: bytes, p: int, count: int, maximum: int | None) -> tuple[list[str], int]:
    """`count` wstrings from position `p` on, and the position after them."""
    from ifgen_runtime.codec.decoding import Reader  # few programs meet a wstring

    reader = Reader(data, "<", p)
    return [reader.wide_text(maximum) for _ in repeat(None, count)], reader.position
