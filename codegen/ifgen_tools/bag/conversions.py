"""Converts recorded messages between two definitions, field by field, as far as no person has to decide.

What each field becomes is decided where `ifgen adapt` does it; here the expressions run, instead of being
written into a module.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

from ifgen.definition.interfaces import Message, Registry
from ifgen.dynamic.making import make
from ifgen.evolution.adapting.steps import PARAMETERS, Function, Functions
from ifgen.evolution.adapting.versions import TwoVersions
from ifgen_runtime.codec import deserialize, serialize

_BUILTINS: Final = {name: getattr(builtins, name) for name in ("bytes", "float")}
"""The functions that the expressions of conversions call."""


@dataclass(frozen=True, slots=True)
class Loss:
    """The losses of a conversion, and what it leaves open. `place` is `pkg/msg/Name.field`."""

    place: str
    reason: str
    is_lost: bool


@dataclass(frozen=True, slots=True)
class Conversion:
    """From bytes of one definition to bytes of another; what becomes of the fields is in `losses`."""

    convert: Callable[[bytes], bytes]
    losses: tuple[Loss, ...] = ()


def conversion(old: Message, old_registry: Registry, new: Message, new_registry: Registry) -> Conversion:
    """The conversion from an old to a new definition of a message.

    Fields that nobody decided on get their default values. Their names are in `losses`, with those that
    the new definition has no field for.
    """

    def today(name: str) -> Any:
        interface = new_registry.get(name)
        return None if interface is None else (interface, new_registry)

    functions = Functions(TwoVersions(old, new, old_registry, new_registry, today, ""))
    functions.add("upgrade", "upgrade", old, new)
    made: dict[str, Any] = {}
    for function in functions:
        made[function.name] = _compiled(function, make(function.target, new_registry), made)
    old_class, upgrade = make(old, old_registry), made["upgrade"]

    def convert(data: bytes) -> bytes:
        return bytes(serialize(upgrade(deserialize(data, old_class))))

    return Conversion(convert, tuple(loss for function in functions for loss in _losses(function)))


def _compiled(function: Function, target: type[Any], others: dict[str, Any]) -> Callable[[Any], Any]:
    """The function as Python runs it. Names are safe, because whoever read the definitions checked them."""
    values = ", ".join(f"{name}={value}" for name, value in function.converted())
    source = f"lambda {PARAMETERS[function.direction]}: _target_({values})"
    names = {"__builtins__": _BUILTINS, "_target_": target, **others}
    compiled: Callable[[Any], Any] = eval(source, names)
    return compiled


def _losses(function: Function) -> Iterator[Loss]:
    for field in function.lost:
        place = f"{function.source.type_name}.{field.name}"
        yield Loss(place, "the new definition has no such field", is_lost=True)
    for step in function.steps:
        if step.question:
            place = f"{function.target.type_name}.{step.target.name}"
            yield Loss(place, step.question, is_lost=step.source is not None)
