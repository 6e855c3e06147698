"""Obstacles in the world: words, random places, motion, touches, and how they look."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from humanoid.control.posture import standing
from humanoid.control.reference import GaitParameters
from humanoid.robot import model as models
from humanoid.robot.obstacles import random_solids, solid_of, solids_of, words_of
from humanoid.simulation.sim import Simulator

FEET = [np.array([0.0, side, 0.0]) for side in (0.09, -0.09)]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("red_box", "is not an obstacle"),
        ("red_box 1 x", "is not an obstacle"),
        ("red_box 1 2 0.3 0.5 7", "is not an obstacle"),
        ("blue_box 1 2", "the colour is one of red, green"),
        ("red_ball 1 2", "box or cylinder"),
        ("red_box nan 2", "within 50 m"),
        ("red_box 1 2 9", "the width must be"),
    ],
)
def test_what_is_no_obstacle_is_said(words: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        solid_of(words)


def test_obstacles_in_words() -> None:
    red, green = solids_of(["red_box 1.2 0.3", "", "green_cylinder_2 2 -0.5 0.2 0.7"])
    assert (red.kind, red.x, red.y, red.width, red.height) == ("box", 1.2, 0.3, 0.3, 0.5)
    assert (green.kind, green.width, green.height, green.radius) == ("cylinder", 0.2, 0.7, 0.1)
    assert solid_of(words_of(green)) == green
    with pytest.raises(ValueError, match="two obstacles are called 'red_box': append a number"):
        solids_of(["red_box 1 1", "red_box 2 2"])


def test_random_obstacles_leave_room() -> None:
    for seed in (*range(20), 212):  # in 212, four that come first leave no room for a fifth
        solids = random_solids(seed, 5, (0.6, -1.2, 3.4, 1.2), [(0.0, 0.0), (4.0, 0.0)])
        assert solids == random_solids(seed, 5, (0.6, -1.2, 3.4, 1.2), [(0.0, 0.0), (4.0, 0.0)])
        assert len(solids) == 5
        assert len({solid.name for solid in solids}) == len(solids)
        assert all(math.dist((a.x, a.y), (b.x, b.y)) > 1.0 for a, b in combinations(solids, 2))
        assert all(math.hypot(solid.x, solid.y) > 0.8 for solid in solids)
    assert random_solids(1, 5, (0.0, -1.0, 3.0, 1.0)) != random_solids(2, 5, (0.0, -1.0, 3.0, 1.0))


def test_an_obstacle_is_solid_moves_and_notices_touches() -> None:
    solids = solids_of(["red_box 2 0", "green_cylinder 0 2"])
    model = models.load(solids=solids)
    simulator = Simulator(model, solids=solids)
    posture, base = standing(model, FEET, GaitParameters())
    simulator.reset(posture, base)
    obstacles = simulator.obstacles
    assert "the robot is there" in obstacles.move("red_box", 0.1, 0.0)
    assert obstacles.move("table", 1, 1) == (
        "there is no obstacle 'table' (there are: red_box, green_cylinder)"
    )
    assert "not finite" in obstacles.move("red_box", math.nan, 0.0)
    assert obstacles.move("red_box", 0.6, 0.0) == ""
    assert [(solid.x, solid.y) for solid in obstacles.solids] == [(0.6, 0.0), (0.0, 2.0)]
    simulator.data.qvel[0] = 1.5  # nobody balances: it falls onto the box
    touches = []
    for _ in range(300):
        simulator.step()
        touches += obstacles.look(simulator.stamp)
    assert touches
    assert {touch.obstacle for touch in touches} == {"red_box"}
    pairs = [(touch.obstacle, touch.link) for touch in touches]
    assert len(pairs) < 20  # a touch that lasts is one
    box = obstacles.solids[0]
    head = simulator.data.xpos[model.mj.body("head").id]
    assert not (abs(head[0] - box.x) < box.width / 2 and abs(head[1]) < 0.1 and head[2] < box.height)
    simulator.reset(posture, base)
    assert obstacles.solids == solids
    assert obstacles.touches == []
    assert np.allclose(simulator.data.xpos[model.mj.body("red_box").id][:2], (2.0, 0.0))
