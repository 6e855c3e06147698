"""Records what the robot did, from messages, and makes pictures of it at the end."""

from __future__ import annotations

from pathlib import Path

import mujoco

from ..data import Footstep
from ..robot.model import HumanoidModel
from ..robot.obstacles import Solid
from ..simulation.rendering import FRAME_TIME, FollowCamera, Picture, RenderingError, save_gif, save_png
from ..simulation.sim import Simulator
from ..spatial import Array
from .follower import Follower

_SMALL, _LARGE = (480, 360), (960, 720)  # pixels
_SPEED = 2  # of the animation: each picture is shown for half the time that it stands for
_PERIOD = FRAME_TIME * 1_000_000 * _SPEED  # ns of simulated time between pictures


def check_writable(path: Path) -> None:
    """Raise RenderingError if a file cannot be written, which permissions alone do not tell."""
    existed = path.exists()
    try:
        path.open("ab").close()
        if not existed:
            path.unlink()
    except OSError as error:
        raise RenderingError(f"--record: {path} cannot be written: {error.strerror}") from None


class Recorder(Follower):
    """Remembers postures and footsteps; it draws at the end, when time no longer matters."""

    def __init__(self, model: HumanoidModel) -> None:
        super().__init__("recorder", model)
        self._shots: list[tuple[Array, tuple[Footstep, ...], tuple[Solid, ...]]] = []
        self._due = 0

    def save(self, path: Path) -> None:
        """Write an animation (.gif) or a picture from early in the walk (.png). Raises RenderingError."""
        if not self._shots:
            raise RenderingError("the robot has not been seen")
        single = path.suffix.lower() == ".png"
        camera = FollowCamera(self._model, *(_LARGE if single else _SMALL))
        stage = Simulator(self._model)
        try:
            if single:
                shots = [shot for shot in self._shots if shot[1]] or self._shots
                save_png(self._draw(camera, stage, *shots[len(shots) // 4]), path)
            else:
                save_gif([self._draw(camera, stage, *shot) for shot in self._shots], path)
        finally:
            camera.close()

    def wants(self, stamp: int) -> bool:
        """Whether the next picture of the animation is due."""
        return stamp >= self._due

    def take(self, stamp: int, posture: Array, steps: tuple[Footstep, ...]) -> None:
        """Keep the posture."""
        self._due = stamp + _PERIOD
        self._shots.append((posture, steps, self.solids))

    @staticmethod
    def _draw(
        camera: FollowCamera,
        stage: Simulator,
        posture: Array,
        steps: tuple[Footstep, ...],
        solids: tuple[Solid, ...],
    ) -> Picture:
        stage.data.qpos[:] = posture
        mujoco.mj_forward(stage.model.mj, stage.data)
        return camera.picture(stage, steps, solids)
