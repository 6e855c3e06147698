"""The window of `ifgen demo`, on a virtual screen of Xvfb."""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from humanoid.data import Footstep, Leg
from humanoid.robot.model import load
from humanoid.show.viewer import SHOWN, frame_line
from humanoid.spatial import Array
from ifgen_runtime.installation import add_extra

pytestmark = pytest.mark.timeout(240)
needs_screen = pytest.mark.skipif(
    shutil.which("Xvfb") is None, reason="Xvfb is not installed (apt install xvfb)"
)
WIDTH, HEIGHT = 960, 600
PATIENCE = 60.0  # s; drawing without a graphics card, on a busy machine


@dataclass(frozen=True)
class Screen:
    name: str
    file: Path

    def picture(self) -> Array:
        """The picture on the screen, (height, width, 3), from the xwd file that Xvfb draws into."""
        raw = self.file.read_bytes()
        header = struct.unpack(">25I", raw[:100])
        size, colours, line = header[0], header[19], header[12]
        pixels = np.frombuffer(raw, np.uint8, HEIGHT * line, size + 12 * colours)
        bgr = pixels.reshape(HEIGHT, line // 4, 4)[:, :WIDTH, :3]
        return bgr[:, :, ::-1].astype(int)


@contextlib.contextmanager
def xvfb(folder: Path, *more: str) -> Iterator[Screen]:
    size = f"{WIDTH}x{HEIGHT}x24"
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", size, "-fbdir", folder, "-nolisten", "tcp", *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert server.stdout is not None
        number = server.stdout.readline().strip()
        assert number, "Xvfb did not start"
        yield Screen(f":{number}", folder / "Xvfb_screen0")
    finally:
        server.terminate()
        server.wait(10)


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    with xvfb(tmp_path) as found:
        yield found


class Demo:
    """A process of `ifgen demo` that ends with the test."""

    def __init__(self, screen: str, *program: str) -> None:
        environment = {key: value for key, value in os.environ.items() if key != "WAYLAND_DISPLAY"}
        self.process = subprocess.Popen(
            [sys.executable, *(program or ("-m", "ifgen", "demo", "--scenario", "walk"))],
            env={**environment, "DISPLAY": screen},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> Demo:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    def until_told(self, words: str) -> None:
        assert self.process.stdout is not None
        assert any(words in line for line in self.process.stdout)

    def warning(self) -> str:
        assert self.process.stderr is not None
        return self.process.stderr.readline()

    def end(self) -> tuple[int, dict[str, str], str]:
        """Wait for the end; returns exit code, rows of the summary, and what else is on stderr."""
        out, errors = self.process.communicate(timeout=PATIENCE)
        assert "Traceback" not in errors
        return (
            self.process.returncode,
            dict(re.findall(r"^  (\S.*?)  +(\S.*)$", out, re.MULTILINE)),
            errors,
        )

    def interrupt(self) -> str:
        """Press Ctrl-C; returns what is on stderr."""
        self.process.send_signal(signal.SIGINT)
        code, summary, errors = self.end()
        assert code == 130
        assert summary["outcome"] == "interrupted"
        return errors


def until(happened: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not happened():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.05)


def green(picture: Array) -> Array:
    """The pixels of footsteps of the left foot."""
    r, g, b = np.moveaxis(picture, 2, 0)
    return (g > 150) & (r < 110) & (b < 130)


def viewer(screen: Screen) -> subprocess.Popen[bytes]:
    environment = {
        **os.environ,
        "DISPLAY": screen.name,
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
    }
    process = subprocess.Popen(
        [sys.executable, "-m", "humanoid.show.viewer", "", ""],
        env=environment,
        cwd=screen.file.parent,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert process.stdout is not None
    assert process.stdout.readline().decode().strip() == SHOWN
    return process


@needs_screen
def test_the_viewer_shows_robot_and_footsteps_and_follows(screen: Screen) -> None:
    robot = load()
    process = viewer(screen)
    pipe = process.stdin
    assert pipe is not None

    def show(x: float, steps: tuple[Footstep, ...]) -> None:
        posture = robot.mj.qpos0.copy()
        posture[:3] = x, 0.0, 0.75
        pipe.write(frame_line(1.0, posture.tolist(), steps))
        pipe.flush()

    def steps(x: float) -> tuple[Footstep, ...]:
        return tuple(Footstep(i, Leg.LEFT, x + 0.3 + 0.25 * i, 0.1, 0.0) for i in range(3))

    until(lambda: (show(0.0, steps(0.0)), np.count_nonzero(green(screen.picture())) > 300)[1])
    before = green(screen.picture())
    until(lambda: (show(0.0, ()), not green(screen.picture()).any())[1])
    # After four metres the picture is the same: the camera has moved with the robot.
    until(lambda: (show(4.0, steps(4.0)), np.mean(green(screen.picture()) == before) > 0.998)[1])
    pipe.close()
    assert process.wait(10) == 0


@pytest.mark.slow
@needs_screen
def test_closing_the_window_ends_the_demo_and_the_summary_is_told(screen: Screen) -> None:
    with Demo(screen.name) as demo:
        until(lambda: bool(green(screen.picture()).any()))
        close_window(screen)
        code, summary, errors = demo.end()
    assert code == 0, errors
    assert summary["outcome"] == "window closed"
    assert float(summary["real-time factor"]) < 1.1


@needs_screen
@pytest.mark.slow
def test_a_window_that_crashes_takes_nothing_with_it(screen: Screen) -> None:
    with Demo(screen.name) as demo:
        until(lambda: bool(green(screen.picture()).any()))
        number = demo.process.pid
        (child,) = Path(f"/proc/{number}/task/{number}/children").read_text().split()
        os.kill(int(child), signal.SIGSEGV)
        assert demo.warning() == "warning: the window is gone: MuJoCo's viewer was ended by signal 11\n"
        demo.interrupt()


@needs_screen
@pytest.mark.slow
def test_without_opengl_one_sentence_says_what_to_do_and_the_demo_goes_on(tmp_path: Path) -> None:
    with xvfb(tmp_path, "-extension", "GLX") as screen, Demo(screen.name) as demo:
        warning = demo.warning()
        assert warning.startswith("warning: no window: GLX: ")
        assert "apt install libgl1" in warning
        demo.until_told("walk to")
        assert "window" not in demo.interrupt()


def test_without_glfw_one_sentence_says_how_to_get_it() -> None:
    program = """if True:
        import sys
        from ifgen.cli.main import main
        sys.modules["glfw"] = None
        sys.argv = ["ifgen", "demo", "--scenario", "walk"]
        main()
    """
    with Demo(":77", "-c", program) as demo:
        assert demo.warning().startswith(f"warning: no window: GLFW is missing: {add_extra('sim')};")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a screen")
def test_without_a_display_no_message_mentions_a_window() -> None:
    with Demo("") as demo:
        demo.until_told("walk to")
        assert "window" not in demo.interrupt()


class ClientMessage(ctypes.Structure):
    """Xlib's event of that name, padded to the longest event."""

    _fields_ = [
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("padding", ctypes.c_long * 12),
    ]


def close_window(screen: Screen) -> None:
    """Send all windows the message that a window manager sends when a user closes them."""
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XDefaultRootWindow.restype = x11.XInternAtom.restype = ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(screen.name.encode()))
    root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
    protocols, delete = (x11.XInternAtom(display, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
    nobody, windows, count = ctypes.c_ulong(), ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
    x11.XQueryTree(display, root, *(ctypes.byref(value) for value in (nobody, nobody, windows, count)))
    for window in windows[: count.value]:
        event = ClientMessage(type=33, window=window, message_type=protocols, format=32)
        event.data[0] = delete
        x11.XSendEvent(display, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(event))
    x11.XCloseDisplay(display)
