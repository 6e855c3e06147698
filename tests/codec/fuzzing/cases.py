"""One case after the other: make it, let all codecs do it, compare."""

from __future__ import annotations

import copy
import operator
from collections.abc import Callable
from random import Random
from typing import Any

from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec import decoding, encoding
from ifgen_runtime.codec.choice import chosen, packer
from ifgen_runtime.message import generated_class
from ifgen_runtime.views import decoders

from . import objects, payloads
from .corpus import LITTLE, PAYLOADS
from .corpus import payloads as good_payloads
from .judge import ENDLESS, copied, exact, outcome, python_codec, python_methods

NATIVE: Any = chosen().extension

_IN_A_ROW = 8
"""Cases of one class in a row, as programs have them."""
_SLOW_ONE_IN = 16
_LEFT_ONE_IN = 8
"""How often Python is asked again what to make of input that C has left to it."""


class Disagreement(AssertionError):
    """Two codecs did different things with the same input."""


class Cases:
    """All cases of a seed, by number."""

    def __init__(self, seed: int, classes: dict[str, type[Any]]) -> None:
        self._seed = seed
        self._names = sorted(classes)
        self._classes = classes
        self._good: dict[str, list[bytes]] = {}
        self._rng = Random()

    def run(self, number: int) -> None:
        """Make a case and raise Disagreement if the codecs do not agree about it."""
        self._rng.seed(self._seed << 40 | number)
        name = self._names[number // _IN_A_ROW % len(self._names)]
        try:
            kind = self._rng.random()
            if kind < 0.5:
                self._bytes(name)
            elif kind < 0.9:
                self._object(name)
            elif kind < 0.94:
                self._copies(name)
            else:
                self._equality(name)
        except Disagreement as difference:
            raise Disagreement(f"case {number} of seed {self._seed}, {name}: {difference}") from None

    def _payload(self, name: str, first: int = PAYLOADS) -> bytes:
        """One of the first good payloads of a class."""
        if name not in self._good:
            cls = self._classes[name]
            self._good[name] = good_payloads(self._seed, cls, python_codec(cls)[0])
        return self._good[name][self._rng.randrange(first)]

    def _bytes(self, name: str) -> None:
        rng, cls = self._rng, self._classes[name]
        data = payloads.mutated(rng, self._payload(name), self._payload(name))
        encode, decode = python_codec(cls)
        left = _left_to_python()
        message, error = outcome(deserialize, data, cls)
        if _left_to_python() == left or rng.randrange(_LEFT_ONE_IN) == 0:
            _same("deserialize", data, _decoded(message, error), _decoded(*outcome(decode, data)))
        if rng.randrange(_SLOW_ONE_IN) == 0:
            slow = outcome(decoding.decode_any, data, cls)
            _same("decode_any", data, _decoded(message, error), _decoded(*slow))
        viewing, refused = outcome(decoders[cls], data)
        _same("with views", data, error, refused)
        if message is not None:
            _same("serialize", data, outcome(serialize, message), outcome(encode, message))
            _same("serialize views", data, outcome(serialize, message), outcome(serialize, viewing))

    def _object(self, name: str) -> None:
        rng, cls = self._rng, self._classes[name]
        encode, _ = python_codec(cls)
        data, seed = self._payload(name, LITTLE), rng.randrange(1 << 60)
        mutator = self._mutated(name, data, seed)
        left = _left_to_python()
        first = outcome(serialize, mutator.message), mutator.acts
        others: list[tuple[str, Callable[[Any], Any]]] = []
        if mutator.is_acting or _left_to_python() == left or rng.randrange(_LEFT_ONE_IN) == 0:
            others.append(("the generated function", encode))
        if rng.randrange(_SLOW_ONE_IN) == 0 and not mutator.is_acting:
            others.append(("encode_any", encoding.encode_any))
        if NATIVE and not mutator.is_acting:
            _same("a parcel", (data, seed), first[0], outcome(_through_parcel, mutator.message))
        for what, function in others:
            again = mutator
            if mutator.is_acting:  # it has changed
                again = self._mutated(name, data, seed)
            _same(what, (data, seed), first, (outcome(function, again.message), again.acts))

    def _mutated(self, name: str, data: bytes, seed: int) -> objects.Mutator:
        decode = python_codec(self._classes[name])[1]
        mutator = objects.Mutator(Random(seed), decode(data), self._other)
        mutator.mutate()
        return mutator

    def _copies(self, name: str) -> None:
        deepcopy = python_methods(self._classes[name])[1]
        data, seed = self._payload(name, LITTLE), self._rng.randrange(1 << 60)
        pairs: list[tuple[Any, Any]] = [
            (copy.deepcopy, lambda message: deepcopy(message, {})),
            (copy.copy, lambda message: copy._reconstruct(message, None, *message.__reduce_ex__(4))),
        ]
        for ours, python in pairs:
            one, other = self._mutated(name, data, seed), self._mutated(name, data, seed)
            # Not how often values acted: a copy inside itself lives until Python collects it.
            _same(ours.__name__, (data, seed), copied(ours, one.message), copied(python, other.message))

    def _equality(self, name: str) -> None:
        equal = python_methods(self._classes[name])[0]
        data, seed = self._payload(name, LITTLE), self._rng.randrange(1 << 60)
        seeds = seed, seed if self._rng.random() < 0.7 else seed + 1
        results = []
        for function in (operator.eq, equal):
            one, other = (self._mutated(name, data, each) for each in seeds)
            equal_or_not, error = outcome(function, one.message, other.message)
            if error.startswith(("AttributeError", "TypeError")):
                error = "of two that are in the wrong, either may be told first"
            results.append(((equal_or_not, error), one.acts, other.acts))
        if not any(ENDLESS in result for result, *_ in results):
            _same("==", (data, seeds), *results)

    def _other(self, rng: Random) -> Any:
        """A message of any class."""
        cls = self._classes[rng.choice(self._names)]
        return cls()


def _through_parcel(message: Any) -> Any:
    """The bytes of a message, after all its arrays were handed over in a parcel."""
    cls = generated_class(type(message))
    before = NATIVE.codec_large_in_parcels(0)
    try:
        parcel = packer(cls)(message)
    finally:
        NATIVE.codec_large_in_parcels(before)
    data = bytes(parcel)
    handed_over = cls.__deserialize__(parcel)
    if exact(handed_over) != exact(cls.__deserialize__(data)):
        raise Disagreement(f"a parcel of {data!r} became {handed_over!r}")
    return data


def _left_to_python() -> int:
    """How many messages C has left to Python until now; always 0 if C does not run."""
    return NATIVE.codec_counts()[2] if NATIVE else 0


def _decoded(message: Any, error: str) -> Any:
    return error or exact(message)


def _same(what: str, given: Any, one: Any, other: Any) -> None:
    if one != other:
        raise Disagreement(
            f"{what}\n  given {given!r}\n  serialize, deserialize: {one!r}\n  {what}: {other!r}"
        )
