"""Functions of a codec that call one another."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.python.body import Body

Reference: TypeAlias = Callable[[NamespacedType], str]
"""The name of a message class in the module."""


def functions(name: str, arguments: str, bodies: Iterable[Body]) -> Iterator[str]:
    """A function of these arguments that returns a new value of the last one, `p`.

    Where it has several bodies, each is a function of its own, and they are called one after another.
    """
    texts = [body.lines(1) for body in bodies]
    if len(texts) > 1:
        calls = [f"{name}_{number}({arguments})" for number in range(1, len(texts) + 1)]
        for call, lines in zip(calls, texts, strict=True):
            yield "\n".join([f"def {call}:", *lines])
        texts = [[*(f"    p = {call}" for call in calls[:-1]), f"    return {calls[-1]}"]]
    yield "\n".join([f"def {name}({arguments}):", *texts[0]])
