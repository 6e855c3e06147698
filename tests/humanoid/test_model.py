"""One table, two files: MuJoCo reads the same robot from the MJCF and from the URDF."""

from __future__ import annotations

import itertools
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from humanoid.robot import table
from humanoid.robot.mjcf import write_mjcf
from humanoid.robot.model import HumanoidModel
from humanoid.robot.urdf import write_urdf
from humanoid.spatial import Array, matrix_of, quaternion_of, rotation_rpy, rotation_vector, vector_of


def _from_urdf() -> mujoco.MjModel:
    options = '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco>'
    return mujoco.MjModel.from_xml_string(write_urdf().replace(">", ">" + options, 1))


def test_has_the_size_it_should_have(model: HumanoidModel) -> None:
    mj = model.mj
    assert (mj.nq, mj.nv, mj.nu, mj.nsensordata) == (36, 35, 29, 24)
    assert abs(model.mass - 35.05) < 1e-9
    assert len(set(table.JOINT_NAMES)) == 29
    assert table.JOINT_NAMES[:6] == tuple(f"l_{name}" for name in table.LEG_JOINTS)
    assert table.JOINT_NAMES[table.WAIST] == table.WAIST_JOINTS
    assert table.JOINT_NAMES[table.ARMS[1]] == tuple(f"r_{name}" for name in table.ARM_JOINTS)


def test_urdf_has_the_same_kinematics(model: HumanoidModel) -> None:
    ours, theirs = model.mj, _from_urdf()
    one, two = mujoco.MjData(ours), mujoco.MjData(theirs)
    one.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    addresses = [theirs.jnt(name).qposadr[0] for name in table.JOINT_NAMES]
    random = np.random.default_rng(0)
    worst = 0.0
    for _ in range(100):
        joints = random.uniform(model.lower, model.upper)
        one.qpos[model.qpos] = joints
        two.qpos[addresses] = joints
        mujoco.mj_kinematics(ours, one)
        mujoco.mj_kinematics(theirs, two)
        for link in table.LINKS[1:]:
            there, here = two.body(link.name), one.body(link.name)
            worst = max(worst, np.abs(there.xpos - here.xpos).max(), np.abs(there.xmat - here.xmat).max())
        for frame in table.FRAMES:
            there, here = two.body(frame.name), one.site(frame.name)
            worst = max(worst, np.abs(there.xpos - here.xpos).max(), np.abs(there.xmat - here.xmat).max())
    assert worst < 1e-9


def test_urdf_has_the_same_masses_inertias_and_limits(model: HumanoidModel) -> None:
    ours, theirs = model.mj, _from_urdf()
    for link in table.LINKS[1:]:
        here, there = ours.body(link.name).id, theirs.body(link.name).id
        assert abs(ours.body_mass[here] - theirs.body_mass[there]) < 1e-12
        assert np.allclose(ours.body_ipos[here], theirs.body_ipos[there], atol=1e-9), link.name
        assert np.allclose(_inertia(ours, here), _inertia(theirs, there), atol=1e-9), link.name
    for name in table.JOINT_NAMES:
        assert np.allclose(ours.jnt(name).range, theirs.jnt(name).range)
    # The URDF's root is welded to the world, and its mass with it.
    root = ElementTree.fromstring(write_urdf())
    masses = [float(mass.attrib["value"]) for mass in root.iter("mass")]
    assert abs(sum(masses) - model.mass) < 1e-9


def _inertia(mj: mujoco.MjModel, body: int) -> Array:
    """Inertia about the centre of mass, in the body's axes: MuJoCo stores it in other axes."""
    x = np.zeros(9)
    mujoco.mju_quat2Mat(x, mj.body_iquat[body])
    axes = x.reshape(3, 3)
    inertia: Array = axes @ np.diag(mj.body_inertia[body]) @ axes.T
    return inertia


def test_frames_point_where_ros_wants_them(model: HumanoidModel) -> None:
    data = model.data()
    mujoco.mj_kinematics(model.mj, data)
    mujoco.mj_camlight(model.mj, data)
    optical = data.site(table.CAMERA_FRAME).xmat.reshape(3, 3)
    assert np.allclose(optical[:, 2], (1, 0, 0))  # z out of the camera
    assert np.allclose(optical[:, 0], (0, -1, 0))  # x to the right
    camera = data.cam("head_camera").xmat.reshape(3, 3)
    assert np.allclose(camera[:, 2], -optical[:, 2])  # MuJoCo's camera looks along -z
    assert np.allclose(data.site("l_gripper").xmat.reshape(3, 3)[:, 0], (0, 0, -1))
    assert data.site("l_sole").xpos[1] > 0 > data.site("r_sole").xpos[1]


def test_right_is_the_mirror_of_left(model: HumanoidModel) -> None:
    data = model.data()
    random = np.random.default_rng(1)
    for left, right, tip in ((*table.LEGS, "sole"), (*table.ARMS, "gripper")):
        joints = np.zeros(29)
        joints[left] = random.uniform(model.lower[left], model.upper[left])
        signs = [1 if joint.axis == (0, 1, 0) else -1 for joint in table.JOINTS[left]]
        joints[right] = joints[left] * signs
        assert (joints >= model.lower).all()
        assert (joints <= model.upper).all()
        data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
        data.qpos[model.qpos] = joints
        mujoco.mj_kinematics(model.mj, data)
        assert np.allclose(data.site(f"l_{tip}").xpos * (1, -1, 1), data.site(f"r_{tip}").xpos)


def test_text_is_the_same_every_time() -> None:
    assert write_mjcf() == write_mjcf()
    assert write_urdf() == write_urdf()


def test_rotations_come_back() -> None:
    random = np.random.default_rng(2)
    turns = [random.normal(size=3) * scale for scale in (1e-9, 1e-3, 1.0) for _ in range(30)]
    turns += [np.pi * np.array(axis) for axis in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(axis)]
    for turn in turns:
        matrix = rotation_vector(turn)
        assert np.allclose(matrix @ matrix.T, np.eye(3))
        assert np.allclose(matrix_of(quaternion_of(matrix)), matrix)
        assert np.allclose(rotation_vector(vector_of(matrix)), matrix, atol=1e-7)
    roll, pitch, yaw = 0.3, -0.4, 2.0
    x = rotation_rpy(roll, pitch, yaw) @ np.array([1.0, 0.0, 0.0])
    assert np.allclose(x, (np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)))


@pytest.mark.parametrize(
    ("moved", "touching"),
    [
        ({}, set()),
        ({"l_shoulder_yaw": -1.5, "l_elbow": -2.0}, {"l_wrist", "torso"}),
        ({"l_hip_roll": -0.3, "r_hip_roll": 0.3}, {"l_shin", "r_shin"}),
    ],
)
def test_links_touch_each_other(model: HumanoidModel, moved: dict[str, float], touching: set[str]) -> None:
    data = model.data()
    for name, position in moved.items():
        data.qpos[model.qpos[model.body.index(name)]] = position
    mujoco.mj_forward(model.mj, data)
    found = [{model.mj.body(model.mj.geom_bodyid[geom]).name for geom in each.geom} for each in data.contact]
    assert touching in found if touching else found == []
