"""The window that shows the robot: a node that follows it and sends frames to MuJoCo's viewer.

The viewer (`viewer.py`) is a process of its own: without a driver or GLFW it ends, and the demo continues.
"""

from __future__ import annotations

import contextlib
import os
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from importlib.util import find_spec
from pathlib import Path

from ifgen_runtime.installation import add_extra

from ..data import SECOND, Footstep
from ..robot.model import HumanoidModel
from ..spatial import Array
from .follower import Follower
from .viewer import SHOWN, frame_line

_PERIOD = 1 / 30  # s of real time between frames
_PATIENCE = 30.0  # s that the window may take to open
_ENDING = 2.0  # s that the viewer has to end
_ADVICE = "on Debian or Ubuntu it needs: apt install libgl1 libgl1-mesa-dri; --headless runs without a window"


class WindowError(RuntimeError):
    """An expected window could not open; the text says why."""


class Window(Follower):
    """Shows the robot from messages alone. Raises WindowError."""

    def __init__(self, model: HumanoidModel, model_parameters: tuple[str, str]) -> None:
        # MuJoCo's viewer writes its errors to a file in the folder where it runs.
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._viewer = _start(model_parameters, self._folder.name)
        self._shown = 0.0
        self._frames: queue.Queue[bytes] = queue.Queue(1)
        super().__init__("window", model)
        threading.Thread(target=self._send, daemon=True).start()

    @property
    def closed(self) -> bool:
        """Whether somebody has closed the window. Raises WindowError if it ended on its own."""
        code = self._viewer.poll()
        if code:
            raise WindowError(f"the window is gone: {_ended(code)}")
        return code == 0

    def wants(self, stamp: int) -> bool:
        """Whether the next frame is due, in real time."""
        return time.monotonic() - self._shown >= _PERIOD

    def take(self, stamp: int, posture: Array, steps: tuple[Footstep, ...]) -> None:
        """Show the posture, unless the viewer is still busy with the one before."""
        self._shown = time.monotonic()
        if not self._frames.full():
            self._frames.put(frame_line(stamp / SECOND, posture.tolist(), steps, self.solids))

    def destroy_node(self) -> None:
        """Close the window too."""
        _end(self._viewer)
        self._folder.cleanup()
        super().destroy_node()

    def _send(self) -> None:
        """Send frames from a thread: writing blocks while the viewer is busy, and nodes must not block."""
        pipe = self._viewer.stdin
        assert pipe is not None
        with contextlib.suppress(OSError):  # the viewer has ended
            while True:
                pipe.write(self._frames.get())
                pipe.flush()


def display() -> bool:
    """Whether there is a display for a window."""
    names = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in names)


def _start(model_parameters: tuple[str, str], folder: str) -> subprocess.Popen[bytes]:
    """Start the viewer and return once its window is open. Raises WindowError."""
    if find_spec("glfw") is None:
        raise WindowError(f"no window: GLFW is missing: {add_extra('sim')}; --headless runs without a window")
    paths = os.pathsep.join(str(Path(path).resolve()) for path in sys.path if path)
    viewer = subprocess.Popen(
        [_python(), "-m", "humanoid.show.viewer", *model_parameters],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    slow = threading.Timer(_PATIENCE, viewer.kill)
    slow.start()
    reason = ""
    try:
        assert viewer.stdout is not None
        for line in viewer.stdout:
            said = line.decode(errors="replace").strip()
            if said == SHOWN:
                return viewer
            reason = said
        raise WindowError(f"no window: {reason or _ended(viewer.wait(_ENDING))}; {_ADVICE}")
    except BaseException:
        _end(viewer)
        raise
    finally:
        slow.cancel()


def _python() -> str:
    """The Python that runs the viewer: on macOS MuJoCo's own, which leaves the main thread to windows."""
    if sys.platform != "darwin":
        return sys.executable
    found = shutil.which("mjpython", path=str(Path(sys.executable).parent)) or shutil.which("mjpython")
    if found is None:
        raise WindowError("no window: on macOS it needs mjpython, which mujoco brings; or use --web")
    return found


def _ended(code: int) -> str:
    return f"MuJoCo's viewer {f'was ended by signal {-code}' if code < 0 else f'ended with exit code {code}'}"


def _end(viewer: subprocess.Popen[bytes]) -> None:
    if viewer.poll() is None:
        viewer.terminate()
    try:
        viewer.wait(_ENDING)
    except subprocess.TimeoutExpired:
        viewer.kill()
        viewer.wait()
