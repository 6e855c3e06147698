"""Pictures of what the robot did: a camera that follows it, marks on the floor, and a line of text."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from ..data import SECOND, Footstep, Mode
from ..robot.model import HumanoidModel
from ..robot.obstacles import Solid
from ..robot.scene import BOARD, BOARD_BODIES, FACE_POSITION
from ..simulation.rendering import Picture, draw_footsteps, draw_solids, renderer
from ..spatial import Array, rotation_z
from .pictures import write_line

_QUARTER = 142.0  # degrees from the robot's heading to that of the camera, which looks at its front
_HEIGHT = 0.66  # m, of the point that the camera looks at
_DISTANCE, _ELEVATION = 2.7, -12.0  # m, degrees
_ABOVE = 3.4, -25.0  # the same where obstacles may hide the robot's feet
_CALM = {"place": 0.5, "heading": 1.2}  # s over which the camera evens out what the robot does
_SUN = np.array([-0.32, -0.42, -0.85])  # where its light goes
_SUN_DISTANCE = 3.0  # m
_SHADOW = 2048  # pixels along an edge of the map of shadows
_EXTENT = 2.0  # m, the unit of the next three
_CLIP, _FOG_BEGINS, _FOG_ENDS = 1.4, 3.0, 9.0
_HORIZON = (0.90, 0.93, 0.96, 1.0)
_GOAL = np.array([0.16, 0.55, 0.95, 0.75], dtype=np.float32)
_GOAL_RADIUS, _POINTER = 0.16, 0.30  # m
_PUSH = np.array([0.95, 0.12, 0.20, 1.0], dtype=np.float32)
_ARROW = 0.012  # m for each N
_CHEST = 1.05  # m, where arrows end
_BROAD = 0.25  # m, half the robot's width with its arms
_CLEAR = 0.6  # m that stay free beside the line of sight where it begins
_BEFORE = 0.85  # of the way to the robot: what is farther away stands beside it


@dataclass(frozen=True, slots=True)
class Shot:
    """What is to be seen at one moment. Lengths in metres, in the frame odom."""

    stamp: int  # ns
    posture: Array  # MuJoCo's `qpos` (nq,)
    steps: tuple[Footstep, ...] = ()
    solids: tuple[Solid, ...] = ()
    mode: Mode = Mode.UNKNOWN
    goal: tuple[float, float, float] | None = None  # x, y, yaw
    push: tuple[float, float] | None = None  # N along x and y

    @property
    def yaw(self) -> float:
        """The robot's heading [rad]."""
        w, x, y, z = self.posture[3:7]
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


@dataclass(frozen=True, slots=True)
class View:
    """Where the camera looks at one moment, and how fast the robot walks there."""

    x: float
    y: float
    azimuth: float  # degrees, as MuJoCo counts them
    speed: float  # m/s


def views(shots: Sequence[Shot]) -> list[View]:
    """A calm view of each shot. Shots are equally far apart in time; their future counts, too."""
    if not shots:
        return []
    period = (shots[-1].stamp - shots[0].stamp) / SECOND / max(len(shots) - 1, 1) or 1.0
    places = np.array([shot.posture[:2] for shot in shots])
    headings = np.unwrap([shot.yaw for shot in shots])
    calm = _smooth(places, _CALM["place"] / period)
    turned = np.degrees(_smooth(headings[:, None], _CALM["heading"] / period)[:, 0])
    velocity = np.gradient(calm, period, axis=0) if len(shots) > 1 else np.zeros_like(calm)
    speeds = np.hypot(velocity[:, 0], velocity[:, 1])
    return [
        View(float(x), float(y), float(turn) + _QUARTER, float(speed))
        for (x, y), turn, speed in zip(calm, turned, speeds, strict=True)
    ]


def _smooth(values: Array, width: float) -> Array:
    """Average columns (n, k) with a bell curve; `width` is its standard deviation, in rows."""
    reach = min(math.ceil(3 * width), 10 * len(values))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(width, 1e-6)) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, bell / bell.sum(), mode="valid") for column in padded.T], axis=1)


class Film:
    """Draws shots. Light, fog and shadows are better than those that the robot's own camera sees.

    Raises RenderingError.
    """

    def __init__(self, model: HumanoidModel, width: int, height: int) -> None:
        self._sole = model.sole
        self._mj = _lit(model.mj, width, height)
        self._data = mujoco.MjData(self._mj)
        self._renderer = renderer(self._mj, width, height)
        self._camera = mujoco.MjvCamera()
        # The scene of somebody else's robot has none.
        bodies = [mujoco.mj_name2id(self._mj, mujoco.mjtObj.mjOBJ_BODY, name) for name in BOARD_BODIES]
        self._board = np.flatnonzero(np.isin(self._mj.geom_bodyid, bodies))

    def draw(self, shot: Shot, view: View, note: str) -> Picture:
        """A picture with a line of text: time, what the robot does, and the note at the right."""
        camera, scene = self._camera, self._renderer.scene
        camera.distance, camera.elevation = _ABOVE if shot.solids else (_DISTANCE, _ELEVATION)
        camera.azimuth = view.azimuth
        camera.lookat[:] = view.x, view.y, _HEIGHT
        eye = _eye(camera)
        self._show_board(not _hides(eye, camera.lookat, FACE_POSITION[:2], BOARD))
        _shine(self._mj, view.x, view.y)
        self._data.qpos[:] = shot.posture
        mujoco.mj_forward(self._mj, self._data)
        self._renderer.update_scene(self._data, camera)
        scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = 1
        draw_footsteps(scene, shot.steps, self._sole)
        draw_solids(scene, shot.solids)
        if shot.goal is not None:
            _draw_goal(scene, shot.goal)
        if shot.push is not None:
            _draw_push(scene, shot.posture[:2], shot.push)
        mode = shot.mode.name.lower().replace("_", " ")
        speed = f", {view.speed:.2f} m/s" if shot.mode is Mode.WALKING else ""
        said = f"{shot.stamp / SECOND:5.1f} s   {mode}{speed}{', pushed' if shot.push else ''}"
        return write_line(np.array(self._renderer.render()), said, note)

    def _show_board(self, shown: bool) -> None:
        """Show the board with the face, or do not draw it."""
        self._mj.geom_rgba[self._board, 3] = float(shown)

    def close(self) -> None:
        """Release OpenGL; otherwise Python complains when it ends."""
        self._renderer.close()


def _eye(camera: Any) -> Array:
    """Where a camera is (3,)."""
    turn, lift = math.radians(camera.azimuth), math.radians(camera.elevation)
    way = np.array([math.cos(lift) * math.cos(turn), math.cos(lift) * math.sin(turn), math.sin(lift)])
    eye: Array = np.asarray(camera.lookat) - camera.distance * way
    return eye


def _hides(eye: Array, seen: Array, place: Sequence[float], radius: float) -> bool:
    """Whether a thing stands before the robot, or so near to the camera that it fills the picture."""
    way = np.asarray(seen[:2]) - eye[:2]
    share = float((np.asarray(place) - eye[:2]) @ way) / float(way @ way)
    beside = float(np.linalg.norm(eye[:2] + share * way - np.asarray(place)))
    room = radius + _BROAD + (1 - share) * _CLEAR
    return -0.2 < share < _BEFORE and beside < room


def _lit(original: Any, width: int, height: int) -> Any:
    """Return a copy of an MjModel with fog at the horizon, and with shadows near the robot alone."""
    mj = copy.copy(original)
    mj.vis.global_.offwidth = max(width, mj.vis.global_.offwidth)
    mj.vis.global_.offheight = max(height, mj.vis.global_.offheight)
    mj.stat.extent = _EXTENT
    mj.vis.map.shadowclip, mj.vis.quality.shadowsize = _CLIP, _SHADOW
    mj.vis.map.fogstart, mj.vis.map.fogend = _FOG_BEGINS, _FOG_ENDS
    mj.vis.rgba.fog[:] = _HORIZON
    mj.vis.headlight.ambient[:], mj.vis.headlight.diffuse[:] = 0.38, 0.28
    mj.vis.headlight.specular[:] = 0.0
    # A floor that casts shadows casts them on itself, as dots.
    mj.geom_castshadow[mj.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = 0
    if mj.nlight:
        mj.light_mode[0] = mujoco.mjtCamLight.mjCAMLIGHT_FIXED
        mj.light_dir[0] = _SUN / np.linalg.norm(_SUN)
        mj.light_diffuse[0] = 0.72
    return mj


def _shine(mj: Any, x: float, y: float) -> None:
    """Let the sun be above the robot: shadows are drawn around the point that it shines at."""
    if mj.nlight:
        mj.light_pos[0] = np.array([x, y, _HEIGHT]) - _SUN_DISTANCE * mj.light_dir[0]


def _draw_goal(scene: Any, goal: tuple[float, float, float]) -> None:
    """A disc where the robot goes, with a pointer to where it will look."""
    x, y, yaw = goal
    disc = np.array([_GOAL_RADIUS, 0.002, 0.0])  # MuJoCo's cylinders: radius, half the height
    _add(scene, mujoco.mjtGeom.mjGEOM_CYLINDER, disc, np.array([x, y, 0.004]), 0.0)
    ahead = _GOAL_RADIUS + _POINTER / 2
    place = np.array([x + ahead * math.cos(yaw), y + ahead * math.sin(yaw), 0.004])
    _add(scene, mujoco.mjtGeom.mjGEOM_BOX, np.array([_POINTER / 2, 0.02, 0.002]), place, yaw)


def _add(scene: Any, kind: Any, size: Array, place: Array, yaw: float) -> None:
    if scene.ngeom < scene.maxgeom:
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, size, place, rotation_z(yaw).flatten(), _GOAL)
        scene.ngeom += 1


def _draw_push(scene: Any, at: Array, push: tuple[float, float]) -> None:
    """An arrow that ends at the chest, as long as the push is strong."""
    if scene.ngeom >= scene.maxgeom:
        return
    force = np.array([*push, 0.0])
    strength = float(np.linalg.norm(force)) or 1.0
    way = force / strength
    end = np.array([at[0], at[1], _CHEST]) - 0.16 * way
    length = max(0.35, min(_ARROW * strength, 1.2))
    geom = scene.geoms[scene.ngeom]
    kind = mujoco.mjtGeom.mjGEOM_ARROW
    mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).flatten(), _PUSH)
    mujoco.mjv_connector(geom, kind, 0.035, end - length * way, end)
    scene.ngeom += 1
