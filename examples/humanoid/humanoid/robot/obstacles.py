"""Solid obstacles on the floor: boxes and cylinders in strong colours, which the head camera tells apart.

In words: `NAME X Y [WIDTH [HEIGHT]]`, where the name begins with a colour and a kind, such as
`red_box 1.2 0.3` or `green_cylinder_2 2 -0.5 0.3 0.6`. Lengths in metres, in odom.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import mujoco
import numpy as np

from ..seeds import generator

Kind = Literal["box", "cylinder"]

# No blue: the robot itself is blue, and so is the sky.
COLOURS: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "red": (0.85, 0.12, 0.10),
        "green": (0.12, 0.62, 0.16),
        "yellow": (0.92, 0.78, 0.08),
        "orange": (0.95, 0.45, 0.05),
        "purple": (0.58, 0.12, 0.62),
    }
)
_WIDTH, _HEIGHT = 0.30, 0.50  # unless the words say otherwise
_NARROWEST, _WIDEST, _LOWEST, _HIGHEST = 0.05, 1.0, 0.05, 1.5
_FARTHEST = 50.0
_FORM = "write COLOUR_KIND X Y [WIDTH [HEIGHT]], such as `red_box 1.2 0.3`"
_APART = 1.1  # m between the middles of two random obstacles: the robot fits through
_FREE = 0.85  # m around places that random obstacles leave free
_TRIES, _ATTEMPTS = 1000, 10


@dataclass(frozen=True, slots=True)
class Solid:
    """An obstacle: `x` and `y` of its middle, `width` of a box's sides or a cylinder's diameter [m]."""

    name: str
    kind: Kind
    colour: tuple[float, float, float]
    x: float
    y: float
    width: float = _WIDTH
    height: float = _HEIGHT

    @property
    def radius(self) -> float:
        """The radius of the circle around it [m]."""
        return self.width / 2 * (math.sqrt(2) if self.kind == "box" else 1.0)


def solid_of(words: str) -> Solid:
    """The obstacle that words describe. Raises ValueError."""
    name, *numbers = words.split() or [""]
    colour, _, rest = name.partition("_")
    kind = rest.partition("_")[0]
    try:
        x, y, width, height = (*map(float, numbers), *(_WIDTH, _HEIGHT)[len(numbers) - 2 :])
    except ValueError:
        raise ValueError(f"'{words}' is not an obstacle: {_FORM}") from None
    if colour not in COLOURS:
        raise ValueError(f"'{words}': the colour is one of {', '.join(COLOURS)}; {_FORM}")
    if kind not in ("box", "cylinder"):
        raise ValueError(f"'{words}': after the colour comes box or cylinder; {_FORM}")
    if not (abs(x) <= _FARTHEST and abs(y) <= _FARTHEST):
        raise ValueError(f"'{words}': its place must be within {_FARTHEST:g} m")
    if not (_NARROWEST <= width <= _WIDEST and _LOWEST <= height <= _HIGHEST):
        raise ValueError(
            f"'{words}': the width must be {_NARROWEST:g} to {_WIDEST:g} m, "
            f"the height {_LOWEST:g} to {_HIGHEST:g} m"
        )
    return Solid(name, "box" if kind == "box" else "cylinder", COLOURS[colour], x, y, width, height)


def solids_of(texts: Iterable[str]) -> tuple[Solid, ...]:
    """The obstacles that texts describe; empty texts are none. Raises ValueError."""
    solids = tuple(solid_of(text) for text in texts if text)
    names = [solid.name for solid in solids]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two obstacles are called '{name}': append a number, such as {name}_2")
    return solids


def words_of(solid: Solid) -> str:
    """An obstacle in words."""
    return f"{solid.name} {solid.x:.3f} {solid.y:.3f} {solid.width:.3f} {solid.height:.3f}"


def random_solids(
    seed: int,
    count: int,
    area: tuple[float, float, float, float],
    free: Sequence[tuple[float, float]] = ((0.0, 0.0),),
) -> tuple[Solid, ...]:
    """Obstacles at random places of an area (x and y from, x and y to).

    Places in `free` stay free, and between any two obstacles there is room to walk. There are fewer than
    `count` if so many do not fit.
    """
    random = generator(seed, "obstacles")
    fullest: list[Solid] = []
    for _ in range(_ATTEMPTS):
        solids = _placed(random, count, area, free)
        fullest = max(fullest, solids, key=len)
        if len(solids) == count:
            break
    return tuple(fullest)


def _placed(
    random: np.random.Generator,
    count: int,
    area: tuple[float, float, float, float],
    free: Sequence[tuple[float, float]],
) -> list[Solid]:
    """Obstacles at random places, until there are enough, or no more fit between those that are there."""
    names = list(COLOURS)
    solids: list[Solid] = []
    for _ in range(_TRIES):
        if len(solids) == count:
            break
        x, y = float(random.uniform(area[0], area[2])), float(random.uniform(area[1], area[3]))
        width, height = float(random.uniform(0.2, 0.4)), float(random.uniform(0.3, 0.7))
        kind: Kind = "box" if random.random() < 0.5 else "cylinder"
        if any(math.dist(place, (x, y)) < _FREE for place in free):
            continue
        if any(math.dist((x, y), (other.x, other.y)) < _APART for other in solids):
            continue
        number, again = len(solids), len(solids) // len(names)
        colour = names[number % len(names)]
        name = f"{colour}_{kind}" + (f"_{again + 1}" if again else "")
        solids.append(Solid(name, kind, COLOURS[colour], x, y, width, height))
    return solids


def add_solids(spec: mujoco.MjSpec, solids: Iterable[Solid]) -> None:
    """Add obstacles to a model: bodies that stand where they are put, whatever bumps into them."""
    for solid in solids:
        body = spec.worldbody.add_body(name=solid.name, pos=[solid.x, solid.y, solid.height / 2], mocap=True)
        half = solid.width / 2
        box = solid.kind == "box"
        body.add_geom(
            name=solid.name,
            type=mujoco.mjtGeom.mjGEOM_BOX if box else mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[half, half, solid.height / 2] if box else [half, solid.height / 2, 0],
            rgba=[*solid.colour, 1],
            contype=1,
            conaffinity=0,
            friction=[0.6, 0.02, 0.001],
        )
