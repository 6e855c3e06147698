"""Numbers of lists and tuples become arrays in C, exactly as `array.array` makes them."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from ifgen_runtime import serialize
from ifgen_runtime.codec.choice import chosen

from .support import Classes

NATIVE: Any = chosen().extension
pytestmark = pytest.mark.skipif(NATIVE is None, reason=f"the codec in C does not run: {chosen().reason}")


class Lines(list[Any]):
    """A list whose items are others than those that are in it."""

    def __iter__(self) -> Any:
        return iter([1, 2])


class Index:
    """An int, if asked."""

    def __index__(self) -> int:
        return 7


VALUES: list[Any] = [
    *(
        [],
        (),
        [0],
        (1, 2),
        [0.1, -0.2],
        (0.1,),
        [1, 0.5],
        [True],
        [-1],
        [-129],
        [200],
        [65536],
        [2**31],
        [2**32],
    ),
    *(
        [2**63],
        [2**64],
        [-(2**63)],
        [2**2000],
        [1e300],
        [float("inf"), float("nan"), -0.0],
        [None],
        ["1"],
        [b"1"],
    ),
    *(
        [Index()],
        [Decimal("0.1")],
        [Fraction(1, 3)],
        [0.1] * 1000,
        Lines([0.5]),
        range(3),
        {1},
        1,
        None,
    ),
    *([0.1, "x"], "12", b"12345678", bytearray(8), array("d", [0.1]), array("B", [1])),
]


def outcome(function: Callable[..., Any], *arguments: Any) -> tuple[Any, ...]:
    """What a call returns or raises, to be compared."""
    try:
        made = function(*arguments)
    except Exception as error:
        return type(error), str(error)
    return type(made), made.typecode, made.tobytes()


@pytest.mark.parametrize("typecode", [*"bBhHiIlLqQfdu", "x", "é"])
def test_the_same_array_or_error(typecode: str) -> None:
    for value in VALUES:
        assert outcome(NATIVE.codec_array, typecode, value) == outcome(array, typecode, value), value


@pytest.mark.parametrize("arguments", [(), ("d",), ("dd", []), (1, []), ("d", [], [])])
def test_other_arguments_are_refused(arguments: tuple[Any, ...]) -> None:
    with pytest.raises(TypeError):
        NATIVE.codec_array(*arguments)


def test_fields_are_set_in_c_once_the_class_has_its_codec(classes: Classes) -> None:
    cls = classes["codec_msgs/msg/Sequences"]
    serialize(cls())
    assert cls.__init__.__globals__["new_array"] is NATIVE.codec_array
    message = cls(doubles=[0.1, 0.2], int8s=(1, 2))
    message.floats = [0.5]
    assert (message.doubles, message.int8s) == (array("d", [0.1, 0.2]), array("b", [1, 2]))
    assert message.floats == array("f", [0.5])
    with pytest.raises(TypeError) as refused:
        message.doubles = [0.1, "x"]
    assert refused.value.__notes__ == ["Sequences.doubles cannot have this value"]
