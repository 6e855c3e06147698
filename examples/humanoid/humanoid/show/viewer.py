"""MuJoCo's viewer in a process of its own, so that a crashing graphics driver does not end the demo.

`python -m humanoid.show.viewer MODEL_FILE JOINT_MAP` (empty: our own robot) prints "shown" on stdout, or what
is wrong. Each line on stdin is a frame. The process ends when stdin does, or with 0 when somebody closes the
window.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import sys
import threading
from dataclasses import astuple
from typing import Any

import mujoco

from ..data import Footstep, Leg
from ..robot.external import load_model
from ..robot.obstacles import Solid
from ..simulation.rendering import aim, draw_footsteps, draw_solids

SHOWN = "shown"
_LOOK = 0.1  # s between checks that the window is still open
_HASTE = 0.1  # share of the way to the robot that the camera moves per frame: it smooths out the swaying
_NICE = 10  # without a graphics card it draws as much as it can, and the robot must not wait for it

Frame = dict[str, Any]


def frame_line(
    seconds: float, posture: list[float], steps: tuple[Footstep, ...], solids: tuple[Solid, ...] = ()
) -> bytes:
    """A line for `main` to read: simulated time, `qpos`, the next footsteps, and obstacles."""
    plan = [[int(step.leg), step.x, step.y, step.yaw] for step in steps]
    frame = {"time": seconds, "posture": posture, "steps": plan, "solids": [astuple(s) for s in solids]}
    return json.dumps(frame).encode() + b"\n"


def main() -> None:
    """Show frames until there are no more, or the window is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the sender of the frames ends this process
    if hasattr(os, "nice"):
        os.nice(_NICE)
    frames: queue.SimpleQueue[Frame | None] = queue.SimpleQueue()
    try:
        window = _Window(*sys.argv[1:])
    except ImportError as error:
        _say(str(error))
        os._exit(1)
    _say(SHOWN)
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nobody reads any longer
    threading.Thread(target=_read, args=(frames,), daemon=True).start()
    while window.open:
        try:
            frame = frames.get(timeout=_LOOK)
            while not frames.empty():  # only the newest one counts
                frame = frames.get()
        except queue.Empty:
            continue
        if frame is None:
            break
        window.show(frame)
    os._exit(0)  # at once: the viewer crashes where Python ends under it


def _read(frames: queue.SimpleQueue[Frame | None]) -> None:
    for line in sys.stdin.buffer:
        frames.put(json.loads(line))
    frames.put(None)


def _on_glfw_error(_: int, description: Any) -> None:
    _say(description.decode())  # bytes, whatever its stubs say


def _say(text: str) -> None:
    print(text, flush=True)


class _Window:
    """The viewer without its panels, which only work in a process that simulates. Raises ImportError.

    If there can be no window, MuJoCo ends the process: GLFW's message before that is printed on stdout.
    """

    def __init__(self, model_file: str, joint_map: str) -> None:
        import glfw  # it raises ImportError if its library is missing
        from mujoco import viewer

        glfw.set_error_callback(_on_glfw_error)
        if not glfw.init():
            os._exit(1)
        self._model = load_model(model_file, joint_map)
        self._stage = self._model.data()
        self._viewer = viewer.launch_passive(
            self._model.mj, self._stage, show_left_ui=False, show_right_ui=False
        )
        self._at = self._stage.qpos[:2].copy()
        aim(self._viewer.cam, *self._at)

    @property
    def open(self) -> bool:
        """False once somebody has closed the window."""
        return bool(self._viewer.is_running())

    def show(self, frame: Frame) -> None:
        """Show the robot where it is and follow it with the camera, which the user may move as well."""
        stage = self._stage
        stage.time, stage.qpos[:] = frame["time"], frame["posture"]
        mujoco.mj_forward(self._model.mj, stage)
        steps = [Footstep(0, Leg(leg), x, y, yaw) for leg, x, y, yaw in frame["steps"]]
        with self._viewer.lock():
            self._viewer.user_scn.ngeom = 0
            draw_footsteps(self._viewer.user_scn, steps, self._model.sole)
            draw_solids(self._viewer.user_scn, [Solid(*solid) for solid in frame["solids"]])
            way = _HASTE * (stage.qpos[:2] - self._at)
            self._viewer.cam.lookat[:2] += way
            self._at += way
        self._viewer.sync()


if __name__ == "__main__":
    main()
