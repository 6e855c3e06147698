"""Images, and finding the face in them."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
from humanoid.control.posture import standing
from humanoid.control.reference import GaitParameters
from humanoid.robot import scene, table
from humanoid.robot.model import HumanoidModel
from humanoid.sensing.face_detection import detect
from humanoid.sensing.regions import label_regions
from humanoid.simulation import rendering
from humanoid.simulation.sim import Simulator
from humanoid.spatial import Array

EXAMPLES = str(Path(__file__).parents[2] / "examples/humanoid")
FEET = [np.array([0.0, side, 0.0]) for side in (0.09, -0.09)]


@pytest.fixture(scope="module", autouse=True)
def _opengl() -> None:
    try:
        rendering.choose_gl()
    except rendering.RenderingError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def camera(model: HumanoidModel) -> Iterator[rendering.HeadCamera]:
    camera = rendering.HeadCamera(model)
    yield camera
    camera.close()


def _look(model: HumanoidModel, place: tuple[float, float], heading: float, nod: float = 0.0) -> Simulator:
    """The robot standing at a place on the floor, with its head pitched."""
    simulator = Simulator(model)
    joints, base = standing(model, FEET, GaitParameters())
    joints[table.JOINT_NAMES.index("head_pitch")] = nod
    simulator.reset(joints, base + np.array([*place, 0.0]))
    simulator.data.qpos[3:7] = (math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2))
    mujoco.mj_forward(model.mj, simulator.data)
    return simulator


def _face(simulator: Simulator) -> Array:
    """The place of the face in the optical frame."""
    site = simulator.data.site(table.CAMERA_FRAME)
    seen: Array = site.xmat.reshape(3, 3).T @ (np.array(scene.FACE_POSITION) - site.xpos)
    return seen


def test_the_face_is_found_where_it_is(model: HumanoidModel, camera: rendering.HeadCamera) -> None:
    random = np.random.default_rng(0)
    found, errors = 0, []
    for _ in range(40):
        distance, slant = random.uniform(1.2, 5.0), random.uniform(-1.0, 1.0)
        place = (
            scene.FACE_POSITION[0] - distance * math.cos(slant),
            scene.FACE_POSITION[1] - distance * math.sin(slant),
        )
        simulator = _look(model, place, slant + random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2))
        faces = detect(camera.picture(simulator), table.CAMERA_FOVY)
        assert len(faces) <= 1
        if faces:
            found += 1
            truth = _face(simulator)
            errors.append(float(np.linalg.norm(faces[0].position - truth) / np.linalg.norm(truth)))
            left, top, width, height = faces[0].region
            focal = 120 / math.tan(math.radians(table.CAMERA_FOVY / 2))
            column, row = 160 + focal * truth[0] / truth[2], 120 + focal * truth[1] / truth[2]
            assert left < column < left + width
            assert top < row < top + height
    assert found >= 38
    assert np.mean(errors) < 0.05
    assert max(errors) < 0.15


def test_nothing_is_found_where_no_face_is(model: HumanoidModel, camera: rendering.HeadCamera) -> None:
    random = np.random.default_rng(1)
    for _ in range(30):
        simulator = _look(
            model, (random.uniform(-5, 2), random.uniform(-3, 3)), math.pi + random.uniform(-0.8, 0.8)
        )
        simulator.data.qpos[model.qpos[table.UPPER_BODY]] = random.uniform(
            model.lower[table.UPPER_BODY], model.upper[table.UPPER_BODY]
        )
        mujoco.mj_forward(model.mj, simulator.data)
        if _face(simulator)[2] < 0:
            assert detect(camera.picture(simulator), table.CAMERA_FOVY) == []


def _drawn(eyes: bool, mouth: bool, ring: int = 20) -> np.ndarray:
    """A face drawn by hand, with parts left out."""
    picture = np.full((240, 320, 3), 150, dtype=np.uint8)
    y, x = np.mgrid[:240, :320]
    picture[70:170, 110:210] = ring
    picture[(x - 160) ** 2 + (y - 120) ** 2 < 40**2] = 240
    if eyes:
        for side in (-15, 15):
            picture[(x - 160 - side) ** 2 + (y - 108) ** 2 < 8**2] = 20
    if mouth:
        picture[134:143, 142:179] = 20
    return picture


def test_half_a_face_is_none() -> None:
    assert len(detect(_drawn(eyes=True, mouth=True), 60.0)) == 1
    assert detect(_drawn(eyes=True, mouth=True)[::-1].copy(), 60.0) == []  # upside down
    assert detect(_drawn(eyes=False, mouth=True), 60.0) == []
    assert detect(_drawn(eyes=True, mouth=False), 60.0) == []
    assert detect(_drawn(eyes=False, mouth=False), 60.0) == []
    assert detect(_drawn(eyes=True, mouth=True, ring=235), 60.0) == []
    for level in (0, 128, 255):
        assert detect(np.full((120, 160, 3), level, dtype=np.uint8), 60.0) == []
    noise = np.random.default_rng(2).integers(0, 256, (240, 320, 3), dtype=np.uint8)
    assert detect(noise, 60.0) == []


def test_regions_are_those_of_a_flood() -> None:
    random = np.random.default_rng(3)
    for density in (0.2, 0.5, 0.7):
        mask = random.random((40, 50)) < density
        labels, regions = label_regions(mask)
        assert ((labels > 0) == mask).all()
        # Touching pixels belong to one region, and each region is connected: a flood fill finds as many.
        assert (labels[:, 1:] == labels[:, :-1])[mask[:, 1:] & mask[:, :-1]].all()
        assert (labels[1:] == labels[:-1])[mask[1:] & mask[:-1]].all()
        assert len(regions) == _flood(mask)
        for region in regions:
            rows, columns = np.nonzero(labels == region.label)
            assert region.area == len(rows)
            assert region.box == (rows.min(), columns.min(), rows.max() + 1, columns.max() + 1)
    assert label_regions(np.zeros((3, 3), dtype=bool))[1] == []


def _flood(mask: np.ndarray) -> int:
    left = {(int(y), int(x)) for y, x in zip(*np.nonzero(mask), strict=True)}
    pieces = 0
    while left:
        pieces += 1
        edge = [left.pop()]
        while edge:
            y, x = edge.pop()
            for near in ((y - 1, x), (y + 1, x), (y, x - 1), (y, x + 1)):
                if near in left:
                    left.remove(near)
                    edge.append(near)
    return pieces


_WITHOUT = """
import sys
sys.path.insert(0, sys.argv[1])
from humanoid.robot import model
from humanoid.simulation import rendering
rendering._PROBE = "raise SystemExit(1)"
try:
    rendering.HeadCamera(model.load())
except rendering.RenderingError as error:
    print(error)
"""


def test_where_nothing_can_draw_the_packages_are_named() -> None:
    environment = {
        key: value for key, value in os.environ.items() if key not in ("MUJOCO_GL", "PYOPENGL_PLATFORM")
    }
    command = [sys.executable, "-c", _WITHOUT, EXAMPLES]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=True)
    assert "apt install libegl1 libegl-mesa0 libgl1-mesa-dri (or libosmesa6)" in done.stdout
    command[2] = _WITHOUT.replace("rendering._PROBE", "unused")
    chosen = {**environment, "MUJOCO_GL": "glfw"}
    done = subprocess.run(command, env=chosen, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith("no picture can be drawn with MUJOCO_GL=glfw")
