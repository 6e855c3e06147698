"""The floor of a scene: where the robot may walk."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A disc on the floor that no foot can stand on."""

    name: str
    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Ground:
    """The area for walking: a square about the origin, less the obstacles. Lengths in metres."""

    half_size: float = 50.0
    obstacles: tuple[Obstacle, ...] = ()
    clearance: float = 0.15  # from the middle of a sole to an obstacle

    def problem(self, x: float, y: float) -> str:
        """The reason why a robot cannot stand at a point, or ""."""
        if max(abs(x), abs(y)) > self.half_size:
            return f"({x:.2f}, {y:.2f}) is off the floor, which ends at {self.half_size:g} m"
        for obstacle in self.obstacles:
            if math.hypot(x - obstacle.x, y - obstacle.y) < obstacle.radius + self.clearance:
                return f"({x:.2f}, {y:.2f}) is occupied by {obstacle.name}"
        return ""
