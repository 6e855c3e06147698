"""The robot over the whole node graph: the tests of test_walking.py, here through messages alone.

Thresholds have slack; benchmarks/humanoid_graph.py prints the exact figures.
"""

from __future__ import annotations

import math
import random
from typing import Any

import pytest

from .graph_process import play

pytestmark = pytest.mark.timeout(300)

Goal = tuple[float, float, float]


def _played(*trials: tuple[str, list[Any], dict[str, Any]]) -> list[dict[str, Any]]:
    """Play trials; none may end in a fall or early."""
    found = play(*trials)
    assert len(found) == len(trials)
    for trial, outcome in zip(trials, found, strict=True):
        assert (outcome["problem"], outcome["falls"]) == ("", 0), trial
    return found


def _goals(seed: int, count: int) -> list[Goal]:
    draw = random.Random(seed).uniform
    return [(draw(-2.0, 2.0), draw(-2.0, 2.0), draw(-math.pi, math.pi)) for _ in range(count)]


@pytest.mark.parametrize("seconds", [5.0, pytest.param(60.0, marks=pytest.mark.slow)])
def test_stands(seconds: float) -> None:
    (stood,) = _played(("stand", [seconds], {"seed": 1}))
    assert 0 < stood["result"] < 8e-3  # it levels itself as its soles correct the IMU


@pytest.mark.slow
def test_walks_twelve_steps_by_sensors_and_by_the_true_state() -> None:
    by_sensors, by_truth = _played(
        ("walk_straight", [], {"seed": 1}), ("walk_straight", [], {"noise": False, "true_state": True})
    )
    assert by_sensors["steps"] == by_truth["steps"] == len(by_truth["foot_errors"]) == 12
    # Its feet stray as much by the true state: little of that is what it senses.
    assert by_sensors["foot_error"] < 0.015
    assert by_truth["foot_error"] < 0.012


@pytest.mark.slow
def test_walks_to_a_goal() -> None:
    (walked,) = _played(("walk_to", [(1.0, 0.5, math.pi / 2), 0.0, 0], {"noise": False, "true_state": True}))
    assert walked["result"] is True
    assert walked["goal_errors"][0] < 0.030


@pytest.mark.slow
def test_stops_when_a_walk_is_cancelled() -> None:
    moments = random.Random(2)
    trials = [
        ("cancel_walk", [goal, moments.uniform(0.1, 5.0)], {"seed": seed})
        for seed, goal in enumerate(_goals(2, 4))
    ]
    for stopped in _played(*trials):
        assert 0 < stopped["stop_times"][0] <= 2.5


@pytest.mark.slow
def test_is_pushed() -> None:
    standing = [("push_standing", [4.0, degrees], {"seed": degrees}) for degrees in (0, 90, 225)]
    (walking,) = _played(*standing, ("push_walking", [3.0, 90.0, 2.9], {"seed": 1}))[3:]
    assert walking["steps"] == 12


def test_a_fall_is_noticed() -> None:
    """The other tests rely on this."""
    (pushed,) = play(("push_standing", [60.0, 90.0], {"seed": 1}))
    assert (pushed["problem"], pushed["falls"]) == ("the robot has fallen", 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wave", "disco", "waltz"])
def test_dances(name: str) -> None:
    (danced,) = _played(("dance", [name], {"seed": 6}))
    assert danced["dances"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("count", [60, 1000])
def test_answers_what_it_can_reach(count: int) -> None:
    (asked,) = _played(("kinematics", [count, 20], {}))
    for chain, (solved, claimed) in asked["result"].items():
        assert solved >= 0.99 * count, chain
        assert claimed == 0, chain


@pytest.mark.slow
@pytest.mark.timeout(1500)
def test_random_goals_with_noise_and_pushes() -> None:
    trials = [("walk_to", [goal, 3.0, seed], {"seed": seed}) for seed, goal in enumerate(_goals(5, 20))]
    assert all(walked["result"] for walked in _played(*trials))
