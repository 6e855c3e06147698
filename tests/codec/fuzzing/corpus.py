"""Good messages of any class, made fast from a random number generator, and their bytes."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from random import Random
from struct import pack, unpack
from typing import Any

import numpy
from ifgen_runtime.codec import creator
from ifgen_runtime.codec.encoding import encode_any
from ifgen_runtime.field_types import Basic, Field, Text, fields_of

from ..big_endian import big_endian

PAYLOADS = 12
"""How many good payloads of a class mutations begin with."""
LITTLE = 9
"""How many of them are in little endian; the others follow."""

_TEXTS = ("", "a", "map", "base_link", "left_shoulder_pitch_joint", "é", "日本", "🤖", "x" * 63, "x" * 300)
_FLOATS = (0.0, -0.0, 0.1, 1.125, -2.5, 1e30, -1e-30, float("inf"), float("-inf"), float("nan"))


def message(rng: Random, cls: type[Any]) -> Any:
    """A message of the class that every codec can send."""
    made = creator(cls)()
    for field in fields_of(cls):
        setattr(made, field.slot, _value(rng, field))
    return made


def _value(rng: Random, field: Field) -> Any:
    if not field.is_collection:
        return element(rng, field.type)
    count = field.size
    if count is None:
        count = rng.choice((0, 0, 1, 2, 3, 5, 17)) if isinstance(field.type, Basic) else rng.randrange(4)
        if field.maximum is not None:
            count = min(count, field.maximum)
    if isinstance(field.type, Basic) and field.type.typecode:
        some = [element(rng, field.type) for _ in range(min(count, 8))]
        values = (some * (count // 8 + 1))[:count]
        if field.size is None:
            return array(field.type.typecode, values)
        return numpy.array(values, field.type.dtype)
    return [element(rng, field.type) for _ in range(count)]


def element(rng: Random, type_: Basic | Text | type[Any]) -> Any:
    """A value of a type that is neither an array nor a sequence."""
    if isinstance(type_, Text):
        return rng.choice(_TEXTS)[: type_.maximum]
    if not isinstance(type_, Basic):
        return message(rng, type_)
    if type_.name == "boolean":
        return rng.random() < 0.5
    if type_.name == "octet":
        return bytes([rng.randrange(256)])
    if type_.name == "char":
        return chr(rng.randrange(256))
    if type_.is_float:
        value = rng.choice(_FLOATS) if rng.random() < 0.5 else rng.gauss(0, 100)
        return unpack("f", pack("f", value))[0] if type_.name == "float" else value
    low, high = type_.range
    return rng.choice((low, high, 0, 1)) if rng.random() < 0.3 else rng.randint(low, high)


def payloads(seed: int, cls: type[Any], encode: Callable[[Any], bytes]) -> list[bytes]:
    """Good payloads of a class, the last ones in big endian; `encode` must agree with the slow codec."""
    rng = Random(f"{seed} {cls.__module__}.{cls.__name__}")
    made = [cls(), *(message(rng, cls) for _ in range(PAYLOADS - 1))]
    little = [encode(each) for each in made]
    assert little == [encode_any(each) for each in made], cls
    return little[:LITTLE] + [big_endian(each) for each in made[LITTLE:]]
