"""What the controller tells of its balance agrees with how the robot stands and walks."""

from __future__ import annotations

import math

import numpy as np
from humanoid.control.support import support_polygon
from humanoid.data import Support
from humanoid.robot.model import HumanoidModel
from humanoid.simulation.sim import QUIET
from humanoid.spatial import Array
from humanoid.trials.harness import Lockstep
from humanoid.trials.trials import STRAIGHT


def area(polygon: Array) -> float:
    """Positive if its corners are counter-clockwise [m2]."""
    x, y = polygon.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def outside(point: Array, polygon: Array) -> float:
    """How far a point is outside a convex polygon; negative inside [m]."""
    ways = np.roll(polygon, -1, axis=0) - polygon
    away = point - polygon
    left = (ways[:, 0] * away[:, 1] - ways[:, 1] * away[:, 0]) / np.linalg.norm(ways, axis=1)
    return float(-left.min())


def test_the_support_is_the_hull_of_the_soles(model: HumanoidModel) -> None:
    sole = model.sole
    one = support_polygon([np.array([1.0, 2.0, math.pi / 6])], sole)
    assert len(one) == 4
    assert math.isclose(area(one), 4 * sole.half_length * sole.half_width)
    assert support_polygon([], sole).shape == (0, 2)
    both = support_polygon([np.array([0.0, 0.1, 0.0]), np.array([0.0, -0.1, 0.0])], sole)
    assert len(both) == 4
    assert math.isclose(area(both), 2 * sole.half_length * (0.2 + 2 * sole.half_width))


def test_the_ground_pushes_within_the_support(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=1, noise=QUIET)
    assert robot.controller.balance() is None
    robot.run(0.5)
    standing = robot.controller.balance()
    assert standing is not None
    middle = standing.support.mean(axis=0)
    for point in (standing.capture_point, standing.zero_moment_point, standing.centre_of_mass[:2]):
        assert np.linalg.norm(point - middle) < 0.05
    assert robot.controller.follow(STRAIGHT) == ""
    areas: dict[Support, float] = {}
    for _ in range(500):
        robot.tick()
        told = robot.controller.balance()
        assert told is not None
        assert outside(told.zero_moment_point, told.support) < 0.002
        areas[robot.controller.state().stance.support] = area(told.support)
    assert areas[Support.LEFT] < 0.7 * areas[Support.BOTH]
