"""Bodies other than ours walk as well as ours, because heights and steps come from their legs."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from humanoid.control.fitting import fitted
from humanoid.control.posture import start
from humanoid.control.reference import GaitParameters
from humanoid.kinematics.dynamics import RobotState
from humanoid.kinematics.head import HeadMode, HeadPose
from humanoid.kinematics.ik import IkRequest, IkStatus, InverseKinematics
from humanoid.kinematics.legs import Legs
from humanoid.planning.dance import problem
from humanoid.robot import table
from humanoid.robot.body import OURS, STRAIGHT_HEIGHT
from humanoid.robot.description import describe_robot
from humanoid.robot.external import load_external
from humanoid.robot.feet import measured_foot
from humanoid.robot.model import HumanoidModel, Names, describe, load
from humanoid.robot.table import ModelError
from humanoid.simulation.sim import Noise
from humanoid.trials.harness import Lockstep

from .bodies import offset_hips, only_legs, shorter_legs


def loaded(folder: Path, text: str) -> HumanoidModel:
    """The model of an MJCF text."""
    path = folder / "robot.xml"
    path.write_text(text)
    return load_external(path)


_LIBRARY = Path(__file__).parents[2] / "examples" / "humanoid"
FOOT = '<geom type="box" size="0.11 0.055 0.0175"'
TOUCHES = 'contype="4" conaffinity="57"'  # of the left leg
REFUSED = [
    ({' 0.0 -0.3"': ' 0.0 -0.05"', '-0.0 -0.3"': '-0.0 -0.05"'}, "the leg of joint 'l_knee' is 0.16 m long from hip to sole; walking takes 0.35 m"),
    ({'name="l_shin" pos="0.0 0.0 -0.3"': 'name="l_shin" pos="0.0 0.0 -0.27"'}, "the leg of joint 'l_knee' is 0.630 m long and that of 'r_knee' 0.660 m: the robot walks on equal legs"),
    ({"-150.0 150.0": "-40.0 40.0", "-150 150": "-40 40"}, "joint 'l_knee' has 40 N m; walking with 35 kg takes 73 N m there"),
    ({TOUCHES: 'contype="0" conaffinity="0"'}, "body 'l_ankle', a foot, has no geom that touches the floor"),
    ({FOOT: FOOT.replace("0.11 ", "0.05 ")}, "the sole of 'l_ankle' is 0.100 m long and 0.110 m wide; walking takes 0.12 by 0.05 m"),
    ({'<freejoint name="floating_base" />': ""}, "body 'base_link' has no free joint, so the robot cannot move"),
    ({'name="waist_yaw" axis="0.0 0.0 1.0"': 'name="waist_yaw" type="ball"'}, "joint 'waist_yaw' is not a hinge"),
    ({'"l_hip_yaw_link" pos="0.0 0.09': '"l_hip_yaw_link" pos="0.0 0.05', '"r_hip_yaw_link" pos="0.0 -0.09': '"r_hip_yaw_link" pos="0.0 -0.05'}, "the soles are 0.10 m apart with all joints at zero; the robot walks with 0.12 to 0.36 m"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_cannot_walk_is_refused(tmp_path: Path, changes: dict[str, str], words: str) -> None:
    text = shorter_legs(0.0)
    for old, new in changes.items():
        text = text.replace(old, new)
    with pytest.raises(ModelError) as caught:
        loaded(tmp_path, text)
    assert str(caught.value) == f"{tmp_path}/robot.xml: {words}"


def test_our_own_body_is_what_the_table_says(model: HumanoidModel, tmp_path: Path) -> None:
    names = Names({name: name for name in table.JOINT_NAMES}, "base_link", "torso")
    foot = measured_foot(model.mj, "l_ankle_roll")
    assert foot is not None
    measured = describe(model.mj, names, foot.sole).body
    assert measured.joints == OURS.joints
    assert np.array_equal(measured.lower, OURS.lower)
    assert np.allclose(
        (measured.leg_length, measured.stance_width, *measured.foot),
        (OURS.leg_length, OURS.stance_width, *OURS.foot),
    )
    assert abs(measured.crouch - OURS.crouch) < 1e-3
    assert abs(model.straight_height - STRAIGHT_HEIGHT) < 1e-4
    from_a_file = loaded(tmp_path, shorter_legs(0.0))
    assert from_a_file.body is OURS
    assert fitted(GaitParameters(), from_a_file) == GaitParameters()


def test_heights_come_from_the_legs(tmp_path: Path) -> None:
    model = loaded(tmp_path, shorter_legs(0.2))
    assert abs(model.body.leg_length - (0.8 * 0.6 + 0.06)) < 1e-6
    parameters = fitted(GaitParameters(), model)
    # As far below where straight legs hold it as ours, by the scale of the legs.
    ours = load().straight_height - GaitParameters().com_height
    assert abs((model.straight_height - parameters.com_height) / model.body.scale - ours) < 1e-3
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


def walk(model: HumanoidModel, *goal: float) -> Lockstep:
    """A walk to a goal, by sensors with noise, that ends near it, and without a fall."""
    robot = Lockstep(model, seed=1, noise=Noise())
    robot.run(0.5)
    assert robot.go_to((goal[0], goal[1], goal[2])) < 0.04
    assert not robot.fell
    assert robot.foot_error()[0] <= 0.020
    return robot


def speed(robot: Lockstep) -> float:
    """Between the second landing and the last but one [m/s]: the first and the last step are short."""
    first, last = robot.touchdowns[1], robot.touchdowns[-2]
    return float(np.linalg.norm((last.landed - first.landed)[:2])) / ((last.stamp - first.stamp) * 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [shorter_legs(0.05), shorter_legs(0.2), offset_hips()],
    ids=["5 % shorter", "20 % shorter", "offset hips"],
)
def test_walks_fast_and_where_it_plans(tmp_path: Path, text: str) -> None:
    assert speed(walk(loaded(tmp_path, text), 1.5, 0.0, 0.0)) >= 0.2


@pytest.mark.slow
def test_ankles_that_hardly_bend_make_it_walk_upright_and_slower(tmp_path: Path) -> None:
    text = shorter_legs(0.0).replace('range="-1.0 0.8"', 'range="-0.85 0.8"')
    model = loaded(tmp_path, text)
    assert fitted(GaitParameters(), model).com_height > 0.65
    assert speed(walk(model, 1.5, 0.0, 0.0)) < 0.4


def test_offset_hips_other_arms_and_no_neck(tmp_path: Path) -> None:
    model = loaded(tmp_path, offset_hips())
    assert not model.has_our_legs
    assert model.body.upper_body[3:10] == tuple(f"l_{name}" for name in (*table.ARM_JOINTS, "wrist_yaw"))
    assert "head_yaw" not in model.body.joints
    assert model.body.joints[-2:] == ("l_grip", "r_grip")
    joints, base = start(model)
    state = RobotState(model)
    state.set_posture(base, np.array([0.0, 0.0, 0.0, 1.0]), joints)
    for side in (0, 1):
        place, turn = state.sole(side)
        assert np.abs(turn - np.eye(3)).max() < 1e-5
        assert abs(place[2]) < 1e-5
    answer = HeadPose(model).check(HeadMode.LOOK_AT, np.array([1.0, 0.0, 0.5]), np.array([0, 0, 0, 1.0]))
    assert answer.message == "the robot has no neck: neither head_yaw nor head_pitch"
    reached = InverseKinematics(model).solve(
        IkRequest("left_arm", np.array([0.2, 0.25, 0.3]), np.zeros(4), position_only=True)
    )
    assert reached.status is IkStatus.SOLVED
    assert len(reached.positions) == 7
    refused = InverseKinematics(model).solve(IkRequest("head", np.zeros(3), np.array([0, 0, 0, 1.0])))
    assert refused.message == "the robot has no head: none of its joints is in the model"


@pytest.mark.parametrize("text", [shorter_legs(0.2), offset_hips()], ids=["shorter legs", "offset hips"])
def test_its_description_is_the_same_robot(tmp_path: Path, text: str) -> None:
    model = loaded(
        tmp_path, text.replace('<joint name="l_knee"', '<joint name="l_knee" pos="0.004 0.0 -0.003"')
    )
    described = describe_robot(model)
    options = '<mujoco><compiler fusestatic="false" discardvisual="false"/></mujoco>'
    theirs = mujoco.MjModel.from_xml_string(re.sub("(<robot[^>]*>)", rf"\1{options}", described))
    assert {theirs.joint(number).name for number in range(theirs.njnt)} == set(model.body.joints)
    assert abs(theirs.body_mass.sum() - model.mass) < 1e-6
    ours, data = model.data(), mujoco.MjData(theirs)
    random = np.random.default_rng(0)
    for _ in range(20):
        joints = random.uniform(model.body.lower, model.body.upper)
        ours.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
        ours.qpos[model.qpos] = joints
        for name, angle in zip(model.body.joints, joints, strict=True):
            data.joint(name).qpos[0] = angle
        mujoco.mj_kinematics(model.mj, ours)
        mujoco.mj_kinematics(theirs, data)
        mujoco.mj_comPos(model.mj, ours)
        mujoco.mj_comPos(theirs, data)
        for name in ("l_sole", "r_sole", "l_gripper", "imu_link"):
            site = model.frames[name]
            assert np.abs(data.body(name).xpos - ours.site_xpos[site]).max() < 1e-9
            assert np.abs(data.body(name).xmat - ours.site_xmat[site]).max() < 1e-9
        assert np.abs(data.subtree_com[0] - ours.subtree_com[model.base]).max() < 1e-9


def test_a_walk_that_ends_far_from_its_goal_has_failed(tmp_path: Path) -> None:
    program = tmp_path / "arriving.py"  # a node's module needs an rclpy
    program.write_text(
        f"import sys\nsys.path.insert(0, {str(_LIBRARY)!r})\n"
        "from humanoid.show.director import Score\nscore = Score()\n"
        "score.arrive('walk 1 0 0', 0.03)\nscore.arrive('walk 1 0 0', 0.104)\nprint(score.failures)\n"
    )
    command = [sys.executable, "-m", "ifgen", "run", "--transport", "local", str(program)]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=100, check=True, cwd=_LIBRARY.parents[1]
    )
    assert done.stdout.strip() == "['walk 1 0 0: it ended 104 mm from its goal, more than 80']"


def test_two_legs_are_enough(tmp_path: Path) -> None:
    model = loaded(tmp_path, only_legs())
    assert model.body.joints == table.JOINT_NAMES[:12]
    assert problem("wave", 0.0, body=model.body) == "the robot has no joint r_elbow, which 'wave' moves"
    walk(model, 0.6, 0.0, 0.0)


@pytest.mark.slow
def test_turns_on_offset_hips(tmp_path: Path) -> None:
    walk(loaded(tmp_path, offset_hips()), 1.0, 0.4, 0.8)
