"""Bodies other than ours walk as well as ours, because heights and steps come from their legs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from humanoid.control.fitting import fitted
from humanoid.control.posture import start
from humanoid.control.reference import GaitParameters
from humanoid.kinematics.dynamics import RobotState
from humanoid.kinematics.legs import Legs
from humanoid.robot.body import OURS
from humanoid.robot.external import load_external
from humanoid.robot.model import HumanoidModel
from humanoid.simulation.sim import Noise
from humanoid.trials.harness import Lockstep

from .bodies import shorter_legs


def loaded(folder: Path, text: str) -> HumanoidModel:
    """The model of an MJCF text."""
    path = folder / "robot.xml"
    path.write_text(text)
    return load_external(path)


def test_our_own_body_is_what_the_table_says(model: HumanoidModel, tmp_path: Path) -> None:
    measured = loaded(tmp_path, shorter_legs(0.0)).body
    assert measured.joints == OURS.joints
    assert np.array_equal(measured.lower, OURS.lower)
    assert np.allclose(
        (measured.leg_length, measured.stance_width, *measured.foot),
        (OURS.leg_length, OURS.stance_width, *OURS.foot),
    )
    assert fitted(GaitParameters(), model) == GaitParameters()


def test_heights_come_from_the_legs(tmp_path: Path) -> None:
    model = loaded(tmp_path, shorter_legs(0.2))
    assert abs(model.body.leg_length - (0.8 * 0.6 + 0.06)) < 1e-6
    parameters = fitted(GaitParameters(), model)
    # As far below where straight legs hold it as ours, by the scale of the legs.
    assert abs((model.straight_height - parameters.com_height) / model.body.scale - 0.0223) < 1e-3
    joints, base = start(model)
    state = RobotState(model)
    state.set_posture(base, np.array([0.0, 0.0, 0.0, 1.0]), joints)
    assert abs(state.com[2] - parameters.com_height) < 1e-6
    assert all(abs(state.sole(side)[0][2]) < 1e-6 for side in (0, 1))


def test_a_search_finds_what_the_closed_form_finds(model: HumanoidModel) -> None:
    searched = Legs(replace(model, has_our_legs=False))
    closed, state = Legs(model), RobotState(model)
    random = np.random.default_rng(0)
    pelvis = (np.zeros(3), np.eye(3))
    for number in range(100):
        side = number % 2
        leg = slice(6 * side, 6 * side + 6)
        joints = np.zeros(len(model.lower))
        joints[leg] = random.uniform(model.lower[leg], model.upper[leg])
        joints[leg][3] = random.uniform(0.2, 2.0)
        state.set_posture(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), joints)
        sole = state.sole(side)
        near = joints[leg] + random.uniform(-0.05, 0.05, 6)
        found = searched.solve(side, pelvis, sole, near)
        assert np.abs(found - closed.solve(side, pelvis, sole, near)).max() < 1e-4


@pytest.mark.parametrize("share", [0.05, pytest.param(0.2, marks=pytest.mark.slow)])
def test_walks_on_shorter_legs(tmp_path: Path, share: float) -> None:
    robot = Lockstep(loaded(tmp_path, shorter_legs(share)), seed=1, noise=Noise())
    robot.run(0.5)
    assert robot.go_to((1.0, 0.0, 0.0)) < 0.03
    assert not robot.fell
    assert robot.foot_error()[0] <= 0.020
