"""Broken messages, made from good ones; and those whose values act while a codec looks at them."""

from __future__ import annotations

import gc
from array import array
from collections.abc import Callable
from random import Random
from typing import Any

from ifgen_runtime.field_types import Basic, Field, fields_of

from . import values
from .corpus import element

_ACTING = 0.08
"""The share of new values that act."""


class Mutator:
    """Changes one message in one case."""

    def __init__(self, rng: Random, message: Any, others: Callable[[Random], Any]) -> None:
        self._rng = rng
        self.message = message
        self._others = others
        self.acts = 0
        """How many actions there were."""
        self.is_acting = False

    def mutate(self) -> None:
        """Make none to four changes."""
        for _ in range(self._rng.choice((0, 0, 1, 1, 1, 2, 2, 3, 4))):
            self._change(*self._place())

    def _place(self) -> tuple[Any, Field | None]:
        """A message somewhere inside, and one of its fields."""
        message = self.message
        while True:
            fields = fields_of(message.__class__)
            if not fields:
                return message, None
            field = self._rng.choice(fields)
            if self._rng.random() < 0.25 or isinstance(field.type, Basic) or not isinstance(field.type, type):
                return message, field
            inside = getattr(message, field.slot, None)
            if type(inside) is list and inside:
                inside = self._rng.choice(inside)
            if type(inside) is not field.type:
                return message, field
            message = inside

    def _change(self, message: Any, field: Field | None) -> None:
        if field is None:
            return
        kind = self._rng.random()
        if kind < 0.03:
            if hasattr(message, field.slot):
                delattr(message, field.slot)
        elif kind < 0.06:
            self._change_class(message, field)
        elif kind < 0.5 and field.is_collection:
            self._change_inside(getattr(message, field.slot, None), field)
        else:
            setattr(message, field.slot, self._new_value(field))

    def _change_class(self, message: Any, field: Field) -> None:
        """Make a message inside one with checks, or of a class that a user derived."""
        inside = getattr(message, field.slot, None)
        if isinstance(field.type, type) and type(inside) is field.type:
            if self._rng.random() < 0.5:
                inside._check_fields = True
            else:
                setattr(message, field.slot, derived(field.type, inside))

    def _change_inside(self, collection: Any, field: Field) -> None:
        rng = self._rng
        if type(collection) is list:
            kind = rng.randrange(5)
            if kind == 0 and collection:
                del collection[rng.randrange(len(collection))]
            elif kind == 1:
                collection.append(self._new_element(field))
            elif kind == 2 and collection:
                collection += collection[: rng.randrange(9)]  # the same objects again
            elif collection:
                collection[rng.randrange(len(collection))] = self._new_element(field)
        elif type(collection) is array:
            if rng.random() < 0.5:
                collection.extend(collection[:9])
            elif collection:
                del collection[-1]

    def _new_element(self, field: Field) -> Any:
        if self._rng.random() < 0.3:
            return element(self._rng, field.type)
        return self._new_value(field)

    def _new_value(self, field: Field) -> Any:
        rng = self._rng
        kind = rng.random()
        if kind < _ACTING:
            return self._actor()
        if kind < 0.14:
            return self.message  # a message inside itself
        if kind < 0.24:
            return self._others(rng)
        if kind < 0.34 and isinstance(field.type, Basic):
            return values.numbers(rng)
        if kind < 0.44:
            return [element(rng, field.type) for _ in range(rng.randrange(6))]
        return values.plain(rng)

    def _actor(self) -> Any:
        self.is_acting = True
        seed = self._rng.randrange(1 << 30)

        def act() -> None:
            self.acts += 1
            if self.acts < 50:
                self._act(Random(seed))

        if self._rng.random() < 0.2:
            return values.Dying(act)
        return values.Acting(act, self._rng.choice((0, 1, 2, 300, -1, 2**40)))

    def _act(self, rng: Random) -> None:
        kind = rng.randrange(8)
        field = rng.choice(fields_of(self.message.__class__))
        if kind == 0:
            raise ValueError("of an action")
        if kind == 1:
            raise values.Ended("of an action")
        if kind == 2:
            gc.collect(0)
        elif kind == 3:
            setattr(self.message, field.slot, None)
        elif kind == 4 and hasattr(self.message, field.slot):
            delattr(self.message, field.slot)
        elif kind == 5:
            inside = getattr(self.message, field.slot, None)
            if type(inside) in (list, array):
                del inside[:]
        elif kind == 6:
            inside = getattr(self.message, field.slot, None)
            if type(inside) is list:
                inside += [values.Thing()] * 100


_derived: dict[type[Any], type[Any]] = {}


def derived(cls: type[Any], message: Any) -> Any:
    """The same message as an object of a class that a user derived, with a slot and a dictionary of its own."""
    if cls not in _derived:
        _derived[cls] = type(cls)(cls.__name__, (cls,), {"__module__": cls.__module__, "extra": 1})
    made = object.__new__(_derived[cls])
    for field in fields_of(cls):
        if hasattr(message, field.slot):
            setattr(made, field.slot, getattr(message, field.slot))
    return made
