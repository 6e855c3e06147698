"""Obstacles in the simulation: they can be moved, and whoever touches them is noticed.

An obstacle is a body that stays where it is put: it does not tip over or slide when it is pushed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from ..data import SECOND
from ..robot.obstacles import Solid

_OVER = SECOND // 2  # ns without contact after which the next contact is another touch
_ROOM = 0.30  # m around the middle of the robot where no obstacle can be put


@dataclass(frozen=True, slots=True)
class Touch:
    """A link of the robot has begun to touch an obstacle."""

    stamp: int
    obstacle: str
    link: str


class Obstacles:
    """The obstacles of a simulated world, in MuJoCo's state."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, solids: Iterable[Solid]) -> None:
        self._model, self._data = model, data
        self._initial = {solid.name: solid for solid in solids}
        self._solids = dict(self._initial)
        self._geoms = np.array([model.geom(name).id for name in self._initial], dtype=int)
        self._touching: dict[tuple[str, str], int] = {}  # when each touch was seen last
        self.touches: list[Touch] = []

    @property
    def solids(self) -> tuple[Solid, ...]:
        """The obstacles where they are now."""
        return tuple(self._solids.values())

    def reset(self) -> None:
        """Forget touches; MuJoCo has put the obstacles back where they began."""
        self._solids = dict(self._initial)
        self._touching.clear()
        self.touches.clear()

    def move(self, name: str, x: float, y: float) -> str:
        """Bring an obstacle to another place [m]; returns why not, or ""."""
        solid = self._solids.get(name)
        if solid is None:
            known = ", ".join(self._solids) or "none"
            return f"there is no obstacle '{name}' (there are: {known})"
        if not (math.isfinite(x) and math.isfinite(y)):
            return f"the place of {name} is not finite"
        if math.dist((x, y), self._data.qpos[:2]) < _ROOM + solid.radius:
            return f"{name} cannot go to ({x:g}, {y:g}): the robot is there"
        self._solids[name] = replace(solid, x=x, y=y)
        self._data.mocap_pos[self._model.body(name).mocapid[0], :2] = x, y
        mujoco.mj_forward(self._model, self._data)
        return ""

    def look(self, stamp: int) -> list[Touch]:
        """Return the touches that have begun since the last look."""
        new: list[Touch] = []
        if not self._geoms.size or not self._data.ncon:
            return new
        for pair in self._data.contact.geom[np.isin(self._data.contact.geom, self._geoms).any(axis=1)]:
            obstacle, other = pair if pair[0] in self._geoms else pair[::-1]
            key = self._model.geom(obstacle).name, self._body_of(other)
            if stamp - self._touching.get(key, -_OVER - 1) > _OVER:
                new.append(Touch(stamp, *key))
            self._touching[key] = stamp
        self.touches += new
        return new

    def _body_of(self, geom: int) -> str:
        return str(self._model.body(self._model.geom_bodyid[geom]).name)
