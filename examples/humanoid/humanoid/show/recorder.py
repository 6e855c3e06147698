"""Records what the robot did, from messages, and makes pictures of it at the end."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from geometry_msgs.msg import WrenchStamped
from humanoid_interfaces.msg import GaitState, TaskStatus
from rclpy.qos import DurabilityPolicy, QoSProfile

from ..data import SECOND, Footstep, Mode
from ..robot.model import HumanoidModel
from ..ros import messages
from ..simulation.rendering import RenderingError
from ..spatial import Array
from .film import Film, Shot, views
from .follower import Follower
from .pictures import counted, save_gif, save_mp4, save_png

_SIZES = {".gif": (480, 360), ".mp4": (960, 540), ".png": (960, 720)}  # pixels
_FRAME_TIMES = {".gif": 100, ".mp4": 50, ".png": 100}  # ms between pictures
_LONGEST = 20_000  # ms that an animation lasts; what took longer is shown faster
_SEEN = SECOND // 2  # ns for which an arrow shows a push
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_TASKS = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

Tell = Callable[[int, int], None]
"""Called with how many pictures are drawn, and of how many."""


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
    """Remembers what is to be seen; it draws at the end, when time no longer matters."""

    def __init__(self, model: HumanoidModel, path: Path) -> None:
        super().__init__("recorder", model)
        self._path = path
        self._kind = path.suffix.lower()
        self._shots: list[Shot] = []
        self._now = self._due = 0  # ns of simulated time
        self._mode = Mode.UNKNOWN
        self._goal: tuple[float, float, float] | None = None
        self._push: tuple[float, float] | None = None
        self._pushed = -_SEEN
        self.create_subscription(GaitState, "/gait_state", self._on_gait, _LATCHED)
        self.create_subscription(TaskStatus, "/high_level_task_manager/task", self._on_task, _TASKS)
        self.create_subscription(WrenchStamped, "/humanoid_simulator/push", self._on_push, 10)

    def wants(self, stamp: int) -> bool:
        """Whether the next picture of the animation is due."""
        self._now = stamp
        return stamp >= self._due

    def take(self, stamp: int, posture: Array, steps: tuple[Footstep, ...]) -> None:
        """Keep what is to be seen now."""
        self._due = stamp + _FRAME_TIMES[self._kind] * 1_000_000
        push = self._push if stamp < self._pushed + _SEEN else None
        self._shots.append(Shot(stamp, posture, steps, self.solids, self._mode, self._goal, push))

    def save(self, tell: Tell) -> None:
        """Write an animation, or a picture from the middle of a walk. Raises RenderingError and OSError."""
        if not self._shots:
            raise RenderingError("the robot has not been seen")
        film = Film(self._model, *_SIZES[self._kind])
        try:
            if self._kind == ".png":
                self._save_picture(film)
            else:
                self._save_animation(film, tell)
        finally:
            film.close()

    def _save_picture(self, film: Film) -> None:
        chosen = [i for i, shot in enumerate(self._shots) if shot.steps] or list(range(len(self._shots)))
        number = chosen[len(chosen) // 4]
        save_png(film.draw(self._shots[number], views(self._shots)[number], ""), self._path)

    def _save_animation(self, film: Film, tell: Tell) -> None:
        frame_time = _FRAME_TIMES[self._kind]
        times = max(1, math.ceil(len(self._shots) * frame_time / _LONGEST))
        pairs = list(zip(self._shots, views(self._shots), strict=True))[::times]
        note = "real speed" if times == 1 else f"{times}x speed"
        drawn = counted((film.draw(shot, view, note) for shot, view in pairs), len(pairs), tell)
        if self._kind == ".mp4":
            save_mp4(drawn, self._path, frame_time)
        else:
            save_gif(list(drawn), self._path, frame_time)

    def _on_gait(self, message: GaitState) -> None:
        self._mode = Mode(message.mode) if message.mode in list(Mode) else Mode.UNKNOWN

    def _on_task(self, message: TaskStatus) -> None:
        walks = message.state == TaskStatus.STATE_RUNNING and message.words.startswith("walk")
        x, y, yaw = messages.planar(message.goal)
        self._goal = (float(x), float(y), float(yaw)) if walks else None

    def _on_push(self, message: WrenchStamped) -> None:
        x, y, _ = messages.numbers(message.wrench.force)
        self._push, self._pushed = (float(x), float(y)), self._now
