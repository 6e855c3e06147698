"""The meaning of a field beyond its type, as markers in the annotations of generated messages.

The comments of a definition say it: `float64 speed  # [m/s] [@range 0, 3]` becomes
`speed: Annotated[float, meaning.Unit("m/s"), meaning.Range(minimum=0, maximum=3)]`. `meanings(Class)` reads
them back.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

from ifgen_runtime.message import Message, generated_class


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit of measurement, spelled as in the definition: `m/s`. `-` says that a number has none."""

    name: str


@dataclass(frozen=True, slots=True)
class Range:
    """The smallest and the largest value; None where there is no bound."""

    minimum: float | None = None
    maximum: float | None = None


@dataclass(frozen=True, slots=True, init=False)
class Constants:
    """The prefixes of the constants that are the values of the field, without the last `_`."""

    prefixes: tuple[str, ...]

    def __init__(self, *prefixes: str) -> None:
        object.__setattr__(self, "prefixes", prefixes)


@dataclass(frozen=True, slots=True)
class Frame:
    """The frame that a value is in: `NED`. With `@` before it, the field or the constant that names it."""

    name: str


@dataclass(frozen=True, slots=True)
class Invalid:
    """The value that stands for "no valid data", and when it does."""

    value: float = math.nan
    when: str = ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Invalid) and (self.is_value(other.value), self.when) == (True, other.when)

    def __hash__(self) -> int:
        return hash((str(self.value), self.when))

    def is_value(self, value: float) -> bool:
        """Whether a value is this one; NaN is, where this is NaN."""
        return value == self.value or (math.isnan(self.value) and value != value)  # noqa: PLR0124 - NaN


@dataclass(frozen=True, slots=True)
class Deprecated:
    """The field is deprecated, and what to do instead."""

    advice: str = ""


Marker: TypeAlias = Unit | Range | Constants | Frame | Invalid | Deprecated

_MARKERS: Mapping[str, type[Any]] = {
    cls.__name__: cls for cls in (Unit, Range, Constants, Frame, Invalid, Deprecated)
}


@cache
def meanings(cls: type[Message]) -> Mapping[str, tuple[Marker, ...]]:
    """The markers of each field of a generated message class that has any, by the name of its attribute.

    This reads the text of annotations: type checkers alone know the names of the types in some of them.
    """
    found: dict[str, tuple[Marker, ...]] = {}
    generated = generated_class(cls)
    annotations: dict[str, Any] = dict(generated.__annotations__)
    for name, attribute in vars(generated).items():
        if isinstance(attribute, property) and attribute.fget is not None:
            annotations[name] = attribute.fget.__annotations__.get("return", "")
    for name, annotation in annotations.items():
        if isinstance(annotation, str):
            markers = _markers(annotation) if "meaning" in annotation else []
        else:  # of a class that was made at run time
            markers = [each for each in getattr(annotation, "__metadata__", ()) if isinstance(each, Marker)]
        if markers:
            found[name] = tuple(markers)
    return found


def _markers(annotation: str) -> list[Marker]:
    found: list[Marker] = []
    tree = ast.parse(annotation, mode="eval").body
    if isinstance(tree, ast.Subscript) and isinstance(tree.slice, ast.Tuple):
        for call in tree.slice.elts[1:]:
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute):
                cls = _MARKERS[call.func.attr]
                arguments = [ast.literal_eval(argument) for argument in call.args]
                keywords = {each.arg: ast.literal_eval(each.value) for each in call.keywords if each.arg}
                found.append(cls(*arguments, **keywords))
    return found
