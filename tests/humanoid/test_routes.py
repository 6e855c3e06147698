"""Routes round obstacles, and footsteps along them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from humanoid.data import Leg, Stance, Support
from humanoid.planning.following import SHARP_TURN, blocked_step, body_of, steps_to_last_line
from humanoid.planning.footsteps import PlanStatus, StepLimits, plan_footsteps
from humanoid.planning.routes import CLEARANCE, RouteStatus, disc_points, plan_route
from humanoid.robot.grid import nearest
from humanoid.robot.ground import Obstacle
from humanoid.robot.obstacles import random_solids
from humanoid.spatial import to_frame, wrap

NOTHING = np.zeros((0, 2))
WALL = np.stack([np.full(41, 1.5), np.linspace(-1.0, 1.0, 41)], axis=1)
HERE = Stance(Support.BOTH, (np.array([0.0, 0.09, 0.0]), np.array([0.0, -0.09, 0.0])))
LIMITS = StepLimits()


def room(places: tuple[tuple[float, float], ...], points: np.ndarray) -> float:
    line = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(places)])
    return float(nearest(points, line).min())


def test_a_free_line_is_the_route() -> None:
    route = plan_route((0.0, 0.0), (3.0, 1.0), NOTHING)
    assert (route.status, route.places) == (RouteStatus.PLANNED, ((0.0, 0.0), (3.0, 1.0)))
    far = plan_route((0.0, 0.0), (90.0, 0.0), WALL + (0.0, 5.0))  # noqa: RUF005  # an array is moved
    assert len(far.places) == 2


def test_a_wall_is_walked_round() -> None:
    route = plan_route((0.0, 0.0), (3.0, 0.0), WALL)
    assert route.status is RouteStatus.PLANNED
    assert room(route.places, WALL) >= CLEARANCE - 0.01
    shortest = 2 * math.hypot(1.5, 1.0 + CLEARANCE)
    assert shortest - 0.2 < route.length < shortest * 1.15
    assert len(route.places) < 7


@pytest.mark.parametrize(
    ("goal", "points", "status", "why"),
    [
        ((1.4, 0.3), WALL, RouteStatus.GOAL_OCCUPIED, "is 0.10 m from an obstacle; I keep 0.4 m"),
        ((math.nan, 0.3), WALL, RouteStatus.INVALID_REQUEST, "not finite"),
        ((3.0, 0.0), np.array([[0.1, 0.0]]), RouteStatus.BLOCKED, "where the robot stands"),
        (
            (3.0, 0.0),
            disc_points(Obstacle("ring", 0.0, 0.0, 1.0))[:24],
            RouteStatus.BLOCKED,
            "no way of 0.80 m width leads to (3.00, 0.00)",
        ),
    ],
)
def test_no_route_has_a_reason(
    goal: tuple[float, float], points: np.ndarray, status: RouteStatus, why: str
) -> None:
    route = plan_route((0.0, 0.0), goal, points)
    assert (route.status, route.places) == (status, ())
    assert why in route.message


def test_without_a_search_only_the_straight_line_will_do() -> None:
    assert plan_route((0.0, 0.0), (3.0, 0.0), WALL, search=False).status is RouteStatus.BLOCKED
    assert plan_route((0.0, 0.0), (1.0, 0.0), WALL, search=False).status is RouteStatus.PLANNED


def test_a_robot_beside_an_obstacle_gets_away() -> None:
    points = np.array([[0.3, 0.0], [0.3, 0.1]])
    route = plan_route((0.0, 0.0), (2.0, 0.0), points)
    assert route.status is RouteStatus.PLANNED
    assert room(route.places, points) > 0.25


def test_steps_along_random_routes_keep_away_and_are_steps_that_legs_can_take() -> None:
    walked = 0
    for seed in range(12):
        solids = random_solids(seed, 5, (0.6, -1.2, 3.4, 1.2), [(0.0, 0.0), (4.0, 0.0)])
        points = np.concatenate([disc_points(Obstacle(s.name, s.x, s.y, s.radius)) for s in solids])
        route = plan_route((0.0, 0.0), (4.0, 0.0), points)
        if route.status is not RouteStatus.PLANNED:
            continue
        first, stance = steps_to_last_line(HERE, route.places, LIMITS, None, 3)
        leg = first[-1].leg.other if first else None
        rest = plan_footsteps(stance, (4.0, 0.0, 0.0), first_leg=leg, first_index=3 + len(first))
        assert rest.status is PlanStatus.PLANNED
        steps = [*first, *rest.plan.steps]
        assert [step.index for step in steps] == list(range(3, 3 + len(steps)))
        feet = list(HERE.feet)
        for step, after in zip(steps, [*steps[1:], None], strict=True):
            assert after is None or after.leg is step.leg.other
            ahead, aside = to_frame(feet[step.leg.other.side], step.pose[:2])
            assert 0.10 < step.leg.sign * aside < 0.32
            assert abs(ahead) < LIMITS.forward + 0.05
            assert abs(wrap(step.yaw - feet[step.leg.other.side][2])) < 0.4
            feet[step.leg.side] = step.pose
        assert blocked_step(steps, points, HERE.centre, LIMITS) == ""
        assert min(nearest(points, body_of(step, LIMITS)[None, :2])[0] for step in steps) > 0.32
        walked += 1
    assert walked >= 11


def test_where_there_is_no_room_for_a_bend_the_body_turns_on_the_spot() -> None:
    """Something has been put 0.4 m in front of the robot, and the way out is to the left."""
    box, out = np.array([[0.41, 0.1], [0.41, -0.1]]), [(0.0, 0.0), (0.05, 1.0), (2.0, 1.0)]
    bend, _ = steps_to_last_line(HERE, out, LIMITS, None, 1)
    assert blocked_step(bend, box, np.zeros(3), LIMITS).startswith("step ")
    spot, _ = steps_to_last_line(HERE, out, LIMITS, None, 1, SHARP_TURN)
    assert blocked_step(spot, box, np.zeros(3), LIMITS) == ""


def test_a_step_towards_an_obstacle_is_seen_and_one_away_from_it_is_not() -> None:
    plan = plan_footsteps(HERE, (1.0, 0.0, 0.0), first_leg=Leg.RIGHT).plan
    assert blocked_step(plan.steps, np.array([[0.9, 0.0]]), HERE.centre, LIMITS).startswith(
        "step 2 of 4 is 0."
    )
    assert blocked_step(plan.steps, np.array([[-0.2, 0.0]]), HERE.centre, LIMITS) == ""
    assert blocked_step(plan.steps, NOTHING, HERE.centre, LIMITS) == ""
