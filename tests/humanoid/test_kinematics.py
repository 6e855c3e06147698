"""Inverse kinematics: reachable poses are found, unreachable ones are never claimed."""

from __future__ import annotations

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from humanoid.kinematics import ik
from humanoid.kinematics.chains import CHAINS, ChainKinematics
from humanoid.kinematics.head import HeadMode, HeadPose
from humanoid.kinematics.ik import IkRequest, IkStatus, InverseKinematics
from humanoid.kinematics.leg_ik import solve_leg
from humanoid.robot import table
from humanoid.robot.model import HumanoidModel
from humanoid.spatial import Array, matrix_of, quaternion_of, rotation_vector, vector_of

MORE = pytest.mark.slow


@pytest.fixture(scope="module")
def solver(model: HumanoidModel) -> InverseKinematics:
    return InverseKinematics(model)


def _request(kinematics: ChainKinematics, random: np.random.Generator, chain: str) -> IkRequest:
    position, rotation = kinematics.forward(random.uniform(kinematics.lower, kinematics.upper))
    # A generous timeout: a busy machine must not change the results.
    return IkRequest(chain, position, quaternion_of(rotation), timeout=60.0)


def _residuals(model: HumanoidModel, request: IkRequest, positions: tuple[float, ...]) -> tuple[float, float]:
    """The remaining distance and angle, computed by MuJoCo from the answer alone."""
    data = model.data()
    data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    for name, position in zip(CHAINS[request.chain].joints, positions, strict=True):
        data.qpos[model.mj.jnt(name).qposadr[0]] = position
    mujoco.mj_kinematics(model.mj, data)
    site = data.site(CHAINS[request.chain].tip)
    turn = vector_of(matrix_of(np.asarray(request.orientation)) @ site.xmat.reshape(3, 3).T)
    return float(np.linalg.norm(request.position - site.xpos)), float(np.linalg.norm(turn))


@pytest.mark.parametrize("side", [0, 1])
def test_leg_in_closed_form(model: HumanoidModel, side: int) -> None:
    kinematics = ChainKinematics(model, CHAINS[("left_leg", "right_leg")[side]])
    random = np.random.default_rng(side)
    exact = 0
    for _ in range(500):
        joints = random.uniform(kinematics.lower, kinematics.upper)
        joints[3] = max(joints[3], 0.02)  # a knee bent backwards has another solution
        base = (random.normal(size=3), rotation_vector(random.normal(size=3)))
        sole, rotation = kinematics.forward(joints)
        ankle = sole + rotation @ np.array([0.0, 0.0, model.leg.ankle_height])
        there = (base[0] + base[1] @ ankle, base[1] @ rotation)
        found, missing = solve_leg(model.leg, 1 - 2 * side, base, there)
        again, turned = kinematics.forward(found)
        error = max(np.abs(again - sole).max(), np.abs(turned - rotation).max())
        assert error < 2e-3
        assert missing < 1e-4
        exact += error < 1e-6
    assert exact >= 470  # the others have an almost straight knee, where the leg is shortened


def test_leg_too_far_away_points_there(model: HumanoidModel) -> None:
    target = np.array([0.3, 0.09, -1.5])
    found, missing = solve_leg(model.leg, 1, (np.zeros(3), np.eye(3)), (target, np.eye(3)))
    assert abs(missing - (np.linalg.norm(target - model.leg.hip) - 0.6)) < 1e-3
    assert np.isfinite(found).all()


@pytest.mark.parametrize("chain", sorted(CHAINS))
@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=MORE)])
def test_reachable_poses_are_found(
    model: HumanoidModel, solver: InverseKinematics, chain: str, count: int
) -> None:
    kinematics = ChainKinematics(model, CHAINS[chain])
    random = np.random.default_rng(count)
    solved = 0
    for _ in range(count):
        request = _request(kinematics, random, chain)
        result = solver.solve(request)
        solved += result.status is IkStatus.SOLVED
        assert (np.array(result.positions) >= kinematics.lower).all()
        assert (np.array(result.positions) <= kinematics.upper).all()
        distance, angle = _residuals(model, request, result.positions)
        assert abs(distance - result.position_residual) < 1e-6
        assert abs(angle - result.orientation_residual) < 1e-6
        if result.status is IkStatus.SOLVED:
            assert distance <= ik.POSITION_TOLERANCE
            assert angle <= ik.ORIENTATION_TOLERANCE
    assert solved >= 0.99 * count


@pytest.mark.parametrize("chain", sorted(CHAINS))
def test_what_is_too_far_away_is_never_claimed(
    model: HumanoidModel, solver: InverseKinematics, chain: str
) -> None:
    kinematics = ChainKinematics(model, CHAINS[chain])
    random = np.random.default_rng(3)
    root, length = kinematics.reach()
    for _ in range(200):
        way = random.normal(size=3)
        far = root + way / np.linalg.norm(way) * length * random.uniform(1.01, 2.0)
        result = solver.solve(replace(_request(kinematics, random, chain), position=far))
        assert result.status is IkStatus.UNREACHABLE
        assert "m long" in result.message
        assert len(result.positions) == len(kinematics.chain.joints)


def test_what_is_near_but_impossible_is_not_claimed(solver: InverseKinematics) -> None:
    # The gripper inside the pelvis, pointing up between the hips.
    request = IkRequest("left_arm", np.array([0.0, 0.0, -0.05]), np.array([0.0, 0.0, 0.0, 1.0]), attempts=5)
    result = solver.solve(request)
    assert result.status is IkStatus.ATTEMPTS_EXHAUSTED
    assert result.attempts == 5
    assert "after 5 starts the tip is still" in result.message


def test_equal_requests_have_equal_answers(model: HumanoidModel, solver: InverseKinematics) -> None:
    kinematics = ChainKinematics(model, CHAINS["left_arm"])
    requests = [_request(kinematics, np.random.default_rng(seed), "left_arm") for seed in range(20)]
    again = InverseKinematics(model)
    for request in requests:
        assert solver.solve(request).positions == again.solve(request).positions
    hard = [request for request in requests if solver.solve(request).attempts > 1]
    assert any(
        solver.solve(request).positions != solver.solve(replace(request, random_seed=7)).positions
        for request in hard
    )


def test_seed_and_present_joints_are_where_the_search_starts(
    model: HumanoidModel, solver: InverseKinematics
) -> None:
    kinematics = ChainKinematics(model, CHAINS["right_arm"])
    joints = kinematics.lower + 0.4 * (kinematics.upper - kinematics.lower)
    position, rotation = kinematics.forward(joints)
    request = IkRequest("right_arm", position, quaternion_of(rotation))
    seeded = replace(request, seed=dict(zip(kinematics.chain.joints, joints.tolist(), strict=True)))
    assert solver.solve(seeded).attempts == 1
    assert np.allclose(solver.solve(seeded).positions, joints)
    present = np.zeros(29)
    present[kinematics.indices] = joints
    assert np.allclose(solver.solve(request, present).positions, joints)
    # The waist is not part of the chain: turned, it takes the target out of the arm's way.
    present[table.JOINT_NAMES.index("waist_yaw")] = 0.4
    assert not np.allclose(solver.solve(request, present).positions, joints, atol=1e-2)


def test_position_alone(model: HumanoidModel, solver: InverseKinematics) -> None:
    target = np.array([0.25, 0.2, 0.3])
    request = IkRequest("left_arm", target, np.zeros(4), position_only=True)
    result = solver.solve(request)
    assert result.status is IkStatus.SOLVED
    assert result.position_residual <= ik.POSITION_TOLERANCE


def test_time_runs_out(model: HumanoidModel) -> None:
    seconds = iter(np.arange(0.0, 1e3, 0.4))
    solver = InverseKinematics(model, clock=lambda: float(next(seconds)))
    request = IkRequest("left_arm", np.array([0.0, 0.0, -0.05]), np.array([0.0, 0.0, 0.0, 1.0]), timeout=1.0)
    result = solver.solve(request)
    assert result.status is IkStatus.TIMED_OUT
    assert 1 < result.attempts < 5


NAN = np.array([math.nan, 0.0, 0.0])


@pytest.mark.parametrize(
    ("change", "status", "words"),
    [
        ({"chain": "tail"}, IkStatus.UNKNOWN_CHAIN, "no chain 'tail'; I know left_arm"),
        ({"position": NAN}, IkStatus.INVALID_REQUEST, "not finite"),
        ({"orientation": np.zeros(4)}, IkStatus.INVALID_REQUEST, "quaternion has length 0"),
        ({"seed": {"l_knee": math.inf}}, IkStatus.INVALID_REQUEST, "seed of l_knee"),
        ({"seed": {"left_knee": 0.0}}, IkStatus.INVALID_REQUEST, "'left_knee'"),
        ({"position_tolerance": -1.0}, IkStatus.INVALID_REQUEST, "tolerances"),
        ({"timeout": math.nan}, IkStatus.INVALID_REQUEST, "timeout"),
        ({"attempts": 1_000_000}, IkStatus.INVALID_REQUEST, "attempts"),
    ],
)
def test_bad_requests_are_answered(
    solver: InverseKinematics, change: dict[str, object], status: IkStatus, words: str
) -> None:
    good = IkRequest("left_arm", np.array([0.2, 0.2, 0.2]), np.array([0.0, 0.0, 0.0, 1.0]))
    result = solver.solve(replace(good, **change))  # type: ignore[arg-type]  # the fields are what varies
    assert result.status is status
    assert words in result.message
    assert result.positions == ()


@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=MORE)])
def test_head_poses(model: HumanoidModel, count: int) -> None:
    head = HeadPose(model)
    kinematics = ChainKinematics(model, CHAINS["head"])
    random = np.random.default_rng(count)
    reached = 0
    for _ in range(count):
        position, rotation = kinematics.forward(random.uniform(kinematics.lower, kinematics.upper))
        reached += head.check(HeadMode.POSE, position, quaternion_of(rotation)).reachable
    assert reached >= 0.99 * count
    root, length = kinematics.reach()
    for _ in range(200):
        way = random.normal(size=3)
        far = root + way / np.linalg.norm(way) * length * random.uniform(1.05, 2.0)
        answer = head.check(HeadMode.POSE, far, random.normal(size=4))
        assert not answer.reachable
        assert answer.message


def test_looking_at_points(model: HumanoidModel) -> None:
    head = HeadPose(model)
    kinematics = ChainKinematics(model, CHAINS["head"])
    random = np.random.default_rng(4)
    reached = 0
    for _ in range(300):
        point = random.uniform(-2, 2, size=3)
        answer = head.check(HeadMode.LOOK_AT, point, np.zeros(4), orientation_tolerance=0.01)
        joints = np.array(answer.positions)
        assert (joints >= kinematics.lower - 1e-12).all()
        assert (joints <= kinematics.upper + 1e-12).all()
        off = _gaze_error(kinematics, joints, point)
        assert abs(off - answer.orientation_residual) < 1e-6
        assert answer.reachable == (off <= 0.01)
        reached += answer.reachable
    assert reached > 270


def _gaze_error(kinematics: ChainKinematics, joints: Array, point: Array) -> float:
    gaze, rotation = kinematics.forward(joints)
    way = (point - gaze) / np.linalg.norm(point - gaze)
    return math.acos(min(1.0, float(rotation[:, 0] @ way)))


def test_what_lies_behind_and_below_cannot_be_seen(model: HumanoidModel) -> None:
    answer = HeadPose(model).check(HeadMode.LOOK_AT, np.array([-0.05, 0.0, -0.6]), np.zeros(4))
    assert not answer.reachable
    assert "rad off" in answer.message


@pytest.mark.parametrize(
    ("mode", "position", "tolerance", "words"),
    [
        (0, NAN, 0.0, "finite"),
        (1, NAN, 0.0, "finite"),
        (2, np.ones(3), 0.0, "no mode 2"),
        (0, np.ones(3), -1.0, "tol"),
    ],
)
def test_bad_head_requests(
    model: HumanoidModel, mode: int, position: Array, tolerance: float, words: str
) -> None:
    answer = HeadPose(model).check(mode, position, np.array([0.0, 0.0, 0.0, 1.0]), tolerance)
    assert not answer.reachable
    assert words in answer.message
