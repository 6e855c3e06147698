"""Images of the simulation: those of the head camera, and what other pictures are drawn with.

MuJoCo needs OpenGL for them and reads from MUJOCO_GL which one to use. If that is not set, the candidates are
tried.
"""

from __future__ import annotations

import functools
import importlib
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..data import Footstep, Leg
from ..robot.model import HumanoidModel, SoleGeometry
from ..robot.obstacles import Solid
from ..spatial import rotation_z
from .sim import Simulator

Picture = NDArray[np.uint8]  # (height, width, 3)

PACKAGES = {"egl": "libegl1 libegl-mesa0 libgl1-mesa-dri", "osmesa": "libosmesa6"}
_COLOURS = {Leg.LEFT: (0.2, 0.8, 0.3, 0.6), Leg.RIGHT: (0.95, 0.55, 0.1, 0.6)}
_THICK = 0.002  # m, half the thickness
_PROBE = "import mujoco; mujoco.GLContext(8, 8).make_current()"


class RenderingError(Exception):
    """Images cannot be rendered here; the text says what is missing."""


@functools.cache
def choose_gl() -> str:
    """Make MuJoCo render with an OpenGL that works here; returns its name. Raises RenderingError.

    Each candidate is tried in a process of its own, since a failed one leaves OpenGL unusable.
    """
    if chosen := os.environ.get("MUJOCO_GL"):
        return chosen
    if sys.platform != "linux":
        return ""
    for name in PACKAGES:
        environment = {**os.environ, "MUJOCO_GL": name}
        environment.pop("PYOPENGL_PLATFORM", None)
        command = [sys.executable, "-c", _PROBE]
        probe = subprocess.run(command, env=environment, capture_output=True, timeout=60, check=False)
        if probe.returncode == 0:
            os.environ["MUJOCO_GL"] = name
            importlib.reload(mujoco.rendering.classic.gl_context)  # it has read MUJOCO_GL on import
            return name
    raise RenderingError(
        "no picture can be drawn: neither EGL nor OSMesa works here; on Debian or Ubuntu: "
        f"apt install {PACKAGES['egl']} (or {PACKAGES['osmesa']})"
    )


def check() -> None:
    """Raise RenderingError if images cannot be rendered here."""
    choose_gl()
    image()


class HeadCamera:
    """The robot's camera: small images without shadows, because they are drawn without a graphics card."""

    def __init__(self, model: HumanoidModel, width: int = 320, height: int = 240) -> None:
        self._renderer = renderer(model.mj, width, height)
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0

    def picture(self, simulator: Simulator) -> Picture:
        """The camera's image at this moment."""
        self._renderer.update_scene(simulator.data, "head_camera")
        return np.array(self._renderer.render())

    def close(self) -> None:
        """Release OpenGL; otherwise Python complains when it ends."""
        self._renderer.close()


def aim(camera: Any, x: float, y: float) -> None:
    """Point an MjvCamera at a robot that stands there."""
    camera.distance, camera.azimuth, camera.elevation = 2.6, 125, -14
    camera.lookat[:] = (x, y, 0.65)


def draw_footsteps(scene: Any, steps: Sequence[Footstep], sole: SoleGeometry) -> None:
    """Add flat boxes where feet will land to an MjvScene: green for the left foot, orange for the right."""
    for step in steps[: scene.maxgeom - scene.ngeom]:
        x, y = step.x + sole.centre * math.cos(step.yaw), step.y + sole.centre * math.sin(step.yaw)
        mujoco.mjv_initGeom(
            scene.geoms[scene.ngeom],
            mujoco.mjtGeom.mjGEOM_BOX,
            np.array([sole.half_length, sole.half_width, _THICK]),
            np.array([x, y, _THICK]),
            rotation_z(step.yaw).flatten(),
            np.array(_COLOURS[step.leg], dtype=np.float32),
        )
        scene.ngeom += 1


def draw_solids(scene: Any, solids: Sequence[Solid]) -> None:
    """Add obstacles to an MjvScene."""
    kinds = {"box": mujoco.mjtGeom.mjGEOM_BOX, "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER}
    for solid in solids[: scene.maxgeom - scene.ngeom]:
        half, high = solid.width / 2, solid.height / 2
        mujoco.mjv_initGeom(
            scene.geoms[scene.ngeom],
            kinds[solid.kind],
            np.array([half, half, high] if solid.kind == "box" else [half, high, 0.0]),
            np.array([solid.x, solid.y, solid.height / 2]),
            np.eye(3).flatten(),
            np.array([*solid.colour, 1.0], dtype=np.float32),
        )
        scene.ngeom += 1


def renderer(mj: Any, width: int, height: int) -> mujoco.Renderer:
    """What draws an MjModel. Raises RenderingError."""
    name = choose_gl()
    try:
        return mujoco.Renderer(mj, height, width)
    except (ImportError, RuntimeError, AttributeError, mujoco.FatalError) as error:
        packages = PACKAGES.get(name)
        missing = f"; on Debian or Ubuntu: apt install {packages}" if packages else ""
        raise RenderingError(f"no picture can be drawn with MUJOCO_GL={name}: {error}{missing}") from error


def image() -> ModuleType:
    """Pillow's module `Image`. Raises RenderingError without it."""
    try:
        from PIL import Image  # only pictures need it
    except ImportError as error:
        from ifgen_runtime.installation import add_extra  # of use to an error only

        raise RenderingError(f"pictures need Pillow: {add_extra('sim')}") from error
    return Image
