"""Values that programs put into fields by mistake, or on purpose to break a codec."""

from __future__ import annotations

import enum
import sys
from array import array
from collections import UserString, deque
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

import numpy

Action = Callable[[], None]
"""What a value does to the message that it is part of, when a codec runs one of its methods."""


class Text(str):
    __slots__ = ()


class Whole(int):
    pass


class Real(float):
    pass


class Raw(bytes):
    pass


class Several(list[Any]):
    pass


class Colour(enum.IntEnum):
    RED = 1


class Ended(BaseException):
    """Not an Exception: nobody may catch it."""


class Thing:
    """It has nothing, and the same repr in every process."""

    def __repr__(self) -> str:
        return "<thing>"


class Liar(Thing):
    """It claims to be of another class."""

    def __init__(self, claimed: type[Any]) -> None:
        self._claimed = claimed

    @property
    def __class__(self) -> type[Any]:  # type: ignore[override]  # that is the lie
        return self._claimed


class Acting(Thing):
    """Each of its methods does something to the message first."""

    def __init__(self, act: Action, value: int) -> None:
        self._act = act
        self._value = value

    def __index__(self) -> int:
        self._act()
        return self._value

    def __float__(self) -> float:
        self._act()
        return 1.5

    def __len__(self) -> int:
        self._act()
        return self._value

    def __iter__(self) -> Iterator[Any]:
        self._act()
        return iter([self._value])

    def __bool__(self) -> bool:
        self._act()
        return True

    def __eq__(self, other: object) -> bool:
        self._act()
        return self._value > 2

    def __hash__(self) -> int:
        self._act()
        return 1

    def __deepcopy__(self, memo: dict[int, Any]) -> Acting:
        self._act()
        return Acting(self._act, self._value)


class Dying(Thing):
    """It does something when it is released."""

    def __init__(self, act: Action) -> None:
        self._act = act

    def __del__(self) -> None:
        try:
            self._act()
        except BaseException:  # Python would only print it
            return


_INTEGERS = (
    *(0, 1, -1, 127, 128, -128, -129, 255, 256, 0x7FFF, 0x8000, 0xFFFF, 0x10000, -0x8000, -0x8001),
    *(2**31 - 1, 2**31, 2**32 - 1, 2**32, -(2**31), -(2**31) - 1),
    *(2**63 - 1, 2**63, 2**64 - 1, 2**64, -(2**63), -(2**63) - 1, 10**30, -(10**30)),
)
_REALS = (0.0, -0.0, 0.1, 1e39, -1e39, 3.4028235677973366e38, 1e308, float("nan"), float("inf"), 1e-46)
_TEXTS = ("", "a", "é", "a\0b", "\0", "\ud800", "x\udfff", "\U0010ffff", "日本語", "\xff", "Ā", "x" * 70)
_RAW = (b"", b"a", b"ab", b"\0", bytearray(b"x"), memoryview(b"x"), Raw(b"z"))
_DTYPES = ("uint8", "int8", "float32", "float64", ">f8", "int64", "bool", "complex128", "U3", "O")


def plain(rng: Random) -> Any:
    """A value without methods of its own."""
    kind = rng.randrange(9)
    if kind == 0:
        return rng.choice(_INTEGERS)
    if kind == 1:
        return rng.choice(_REALS)
    if kind == 2:
        return rng.choice(_TEXTS)
    if kind == 3:
        return rng.choice(_RAW)
    if kind == 4:
        return rng.choice((None, True, False, ..., NotImplemented, int, Thing, (), {}, set(), frozenset()))
    if kind == 5:
        return _derived(rng)
    if kind == 6:
        return numbers(rng)
    if kind == 7:
        return _collection(rng)
    return Liar(rng.choice((int, float, str, list, array, bool))) if rng.random() < 0.3 else Thing()


def _derived(rng: Random) -> Any:
    return rng.choice(
        (
            *(Text("abc"), Text("a\0b"), Whole(3), Whole(2**70), Real(0.5), Colour.RED, UserString("user")),
            *(numpy.float64(0.1), numpy.float32(0.1), numpy.int8(-3), numpy.uint64(2**63), numpy.bool_(True)),
            *(numpy.str_("text"), numpy.bytes_(b"q"), Several([1, 2]), Several(["a"])),
        )
    )


def numbers(rng: Random) -> Any:
    """An array of any type, shape and order."""
    count = rng.choice((0, 1, 2, 3, 9, 36))
    if rng.random() < 0.4:
        return array(rng.choice("bBhHiIlLqQfd"), [1] * count)
    values: Any = numpy.zeros(count, rng.choice(_DTYPES))
    shape = rng.randrange(5)
    if shape == 1:
        values = numpy.zeros(count * 2, values.dtype)[::2]
    elif shape == 2:
        values = values[::-1]
    elif shape == 3:
        values = values.reshape(1, count)
    elif shape == 4:
        values.flags.writeable = False
    return values


def _collection(rng: Random) -> Any:
    inside = [rng.choice((0, 1, 1.5, "a", True, b"x", None, 300)) for _ in range(rng.randrange(4))]
    kind = rng.randrange(8)
    if kind == 0:
        return inside
    if kind == 1:
        return tuple(inside)
    if kind == 2:
        return deque(inside)
    if kind == 3:
        return set(inside)
    if kind == 4:
        return dict.fromkeys(inside)
    if kind == 5:
        return range(len(inside))
    endless: list[Any] = [*inside]
    if kind == 6:
        endless.append(endless)
    return endless


def interned(rng: Random) -> str:
    """One of few strings that are the same object everywhere."""
    return sys.intern(rng.choice(("map", "odom", "base_link")))
