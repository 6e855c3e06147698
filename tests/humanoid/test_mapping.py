"""From pictures of the head camera to a map of the floor."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from humanoid.control.posture import standing
from humanoid.control.reference import GaitParameters
from humanoid.data import SECOND
from humanoid.robot import model as models
from humanoid.robot import table
from humanoid.robot.grid import FREE, OCCUPIED, UNKNOWN, Grid, nearest
from humanoid.robot.obstacles import Solid, solids_of
from humanoid.sensing.camera import lens_of
from humanoid.sensing.floor_view import Viewpoints
from humanoid.sensing.mapping import FloorMap
from humanoid.simulation import rendering
from humanoid.simulation.sim import Simulator

FEET = [np.array([0.0, side, 0.0]) for side in (0.09, -0.09)]
LENS = lens_of(160, 120, table.CAMERA_FOVY)
MEMORY = 60 * SECOND


@pytest.fixture(autouse=True)
def _opengl() -> None:
    try:
        rendering.choose_gl()
    except rendering.RenderingError as error:
        pytest.skip(str(error))


class Robot:
    """A robot that stands still and looks; `look` adds to its map what it sees from a place."""

    def __init__(self, words: list[str]) -> None:
        solids = solids_of(words)
        self.model = models.load(solids=solids)
        self.simulator = Simulator(self.model, solids=solids)
        self.joints, self.base = standing(self.model, FEET, GaitParameters())
        self.map = FloorMap()
        self._viewpoints = Viewpoints(self.model)
        self._camera = rendering.HeadCamera(self.model, LENS.width, LENS.height)
        self._stamp = 0
        self.simulator.reset(self.joints, self.base)

    def look(self, x: float = 0.0, y: float = 0.0, heading: float = 0.0, seconds: float = 0.5) -> Grid:
        data = self.simulator.data
        data.qpos[:3] = self.base + np.array([x, y, 0.0])
        data.qpos[3:7] = (math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2))
        mujoco.mj_forward(self.model.mj, data)
        w, *vector = data.qpos[3:7]
        viewpoint = self._viewpoints.of(data.qpos[:3], np.array([*vector, w]), self.joints)
        self._stamp += round(seconds * SECOND)
        picture = self._camera.picture(self.simulator)
        self.map.see(self._stamp, picture, LENS, viewpoint, 3.5, MEMORY)
        return self.map.grid

    def close(self) -> None:
        self._camera.close()


def outside(solid: Solid, places: np.ndarray) -> np.ndarray:
    """How far places are from the edge of an obstacle; 0 inside."""
    off = np.abs(places - (solid.x, solid.y))
    if solid.kind == "cylinder":
        return np.maximum(np.hypot(*off.T) - solid.width / 2, 0.0)
    return np.hypot(*np.maximum(off - solid.width / 2, 0.0).T)


def filled(solid: Solid) -> np.ndarray:
    """Places that an obstacle fills."""
    side = np.linspace(-solid.width / 2, solid.width / 2, 9)
    x, y = np.meshgrid(solid.x + side, solid.y + side)
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    return places[outside(solid, places) < 1e-9]


def test_obstacles_are_mapped_where_they_stand() -> None:
    words = ["red_box 2 0.4", "green_cylinder 1.6 -0.6", "yellow_box 3.0 -0.3", "purple_cylinder 2.6 1.0"]
    robot = Robot([*words, "orange_box -2 0"])
    for x in (0.0, 0.2, 0.4, 0.6):
        grid = robot.look(x)
    robot.close()
    occupied = grid.occupied()
    seen = robot.simulator.obstacles.solids[:4]
    for solid in seen:
        assert nearest(occupied, filled(solid)).max() < 0.20, solid.name
    wrong = np.min([outside(solid, occupied) for solid in seen], axis=0)
    assert wrong.max() < 0.15
    assert np.mean(wrong > 0.05) < 0.03
    for x, y in ((2.4, 0.0), (1.6, 0.2), (2.0, -0.2)):
        assert grid.at(x, y) == FREE, (x, y)
    assert grid.at(-2.0, 0.0) == UNKNOWN  # behind the robot
    assert grid.at(99.0, 0.0) == UNKNOWN


def test_where_two_stand_behind_each_other_each_is_mapped() -> None:
    robot = Robot(["red_box 1.5 0 0.3 0.3", "yellow_cylinder 3.2 0.1 0.4 0.7", "red_box_2 2.4 -0.3 0.3 0.4"])
    for x in (0.0, 0.1, 0.2):
        grid = robot.look(x)
    robot.close()
    occupied = grid.occupied()
    solids = robot.simulator.obstacles.solids
    for solid in solids:
        assert nearest(occupied, filled(solid)).max() < 0.15, solid.name
    wrong = np.min([outside(solid, occupied) for solid in solids], axis=0)
    assert wrong.max() < 0.20
    assert np.mean(wrong > 0.08) < 0.05


def test_from_several_sides_the_map_is_the_obstacle() -> None:
    robot = Robot(["red_box 1.5 0 0.3 0.4"])
    for angle in np.linspace(0, 2 * math.pi, 9):
        grid = robot.look(1.5 - 1.6 * math.cos(angle), -1.6 * math.sin(angle), float(angle))
    robot.close()
    occupied = grid.occupied()
    (solid,) = robot.simulator.obstacles.solids
    assert nearest(occupied, filled(solid)).max() < 0.05
    assert outside(solid, occupied).max() < 0.06


@pytest.mark.parametrize(("x", "stays"), [(0.4, False), (0.9, True)])
def test_what_the_camera_looks_through_is_gone_and_what_it_cannot_see_stays(x: float, stays: bool) -> None:
    robot = Robot(["red_box 1.5 0 0.3 0.5"])
    for before in np.arange(0.0, x, 0.1):
        robot.look(float(before))
    there = filled(robot.simulator.obstacles.solids[0])
    assert nearest(robot.look(x).occupied(), there).max() < 0.1
    assert robot.simulator.obstacles.move("red_box", -3.0, 0.0) == ""
    for _ in range(5):  # its foot is nearer than the lower edge of the picture
        grid = robot.look(x)
    robot.close()
    assert (len(grid.occupied()) > 0) == stays


def test_an_obstacle_that_has_gone_is_cleared_and_one_out_of_sight_is_forgotten() -> None:
    robot = Robot(["red_box 1.8 0"])
    before = robot.look()
    assert before.at(1.68, 0.0) == OCCUPIED
    assert robot.simulator.obstacles.move("red_box", 1.8, 0.8) == ""
    for _ in range(4):
        after = robot.look()
    assert after.at(1.68, 0.0) == FREE
    assert after.at(1.68, 0.8) == OCCUPIED
    away = robot.look(heading=math.pi)
    assert away.at(1.68, 0.8) == OCCUPIED  # it remembers
    late = robot.look(heading=math.pi, seconds=61.0)
    assert late.at(1.68, 0.8) == UNKNOWN
    robot.close()


def test_an_obstacle_right_ahead_is_noticed_and_its_going_away_too() -> None:
    robot = Robot(["red_box 0.75 0"])  # its foot is below the picture
    occupied = robot.look().occupied()
    (solid,) = robot.simulator.obstacles.solids
    assert nearest(occupied, filled(solid)).max() < 0.1
    assert robot.simulator.obstacles.move("red_box", -3.0, 0.0) == ""
    for _ in range(2):
        grid = robot.look()
    robot.close()
    assert len(grid.occupied()) == 0


def test_the_robot_and_the_board_with_the_face_are_no_obstacles() -> None:
    robot = Robot([])
    robot.joints[table.UPPER_BODY.start :] = 0.0
    robot.joints[table.JOINT_NAMES.index("l_shoulder_pitch")] = -1.2
    robot.joints[table.JOINT_NAMES.index("r_shoulder_pitch")] = -0.9
    robot.joints[table.JOINT_NAMES.index("head_pitch")] = 0.4
    robot.simulator.reset(robot.joints, robot.base)
    grid = robot.look()
    robot.close()
    assert (grid.cells == FREE).sum() > 500
    assert len(grid.occupied()) == 0
