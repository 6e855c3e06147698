"""The demo: starts the nodes, plays a scenario, and reports how it went. `ifgen demo` calls `main`."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from ..data import Mode
from ..robot.external import load_model
from ..robot.joint_map import ModelError
from ..simulation.rendering import RenderingError, check
from . import crew
from .director import Director, ScenarioError
from .recorder import Recorder
from .scenarios import SCENARIOS, Scenario
from .web import vendor
from .window import Window, WindowError, display

_LIMIT = 600.0  # s of real time for a scenario
_LINE = 0.1  # s between changes of the progress line
_WITH_BODY = ("imu_fusion", "whole_body_controller", "inverse_kinematics_server")
_ENDING = 5.0  # s that a process has to end
_INTERRUPTED = "interrupted"
_CODE_INTERRUPTED = 130  # as for all commands of ifgen


class _WindowClosedError(Exception):
    """The user has closed the window."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command line."""

    scenario: str = "all"
    transport: str = "local"
    record: Path | None = None
    web: int | None = None  # the port; 0: any free one
    window: bool = False  # if there is a display
    realtime: bool = False
    seed: int = 0
    noise: bool = True
    camera: bool = False
    model: Path | None = None
    joint_map: Path | None = None

    @property
    def model_parameters(self) -> tuple[str, str]:
        """The parameters `model_file` and `joint_map` of the nodes that know the robot's body."""
        paths = (self.model, self.joint_map)
        return str(paths[0].resolve()) if paths[0] else "", str(paths[1].resolve()) if paths[1] else ""


def main(options: Options) -> int:
    """Play a scenario; the exit code is 0 if the robot did what it was asked to and did not fall."""
    try:
        load_model(*options.model_parameters)  # its errors should be reported before nodes start
        if options.web is not None:
            vendor.fetch()
        if options.record is not None:
            check()
    except (ModelError, RenderingError, vendor.VendorError) as error:
        sys.exit(f"error: {error}")
    # Ctrl-C ends the scenario; the summary is still printed.
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    show = _Show(options)
    try:
        return show.play(SCENARIOS[options.scenario])
    finally:
        show.close()
        rclpy.try_shutdown()


class _Show:
    """Everything that runs while a scenario is played."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._hash = ""
        self._begun, self._started = 0.0, time.monotonic()  # simulated and real, of the scenario
        self._line = _ProgressLine()
        self._processes: list[subprocess.Popen[bytes]] = []
        self._executor: Executor = SingleThreadedExecutor()
        self._director = Director(self._say)
        self._recorder = Recorder(load_model(*options.model_parameters)) if options.record else None
        self._window = self._open_window() if options.window and display() else None
        self._nodes: list[Node] = [node for node in (self._director, self._recorder, self._window) if node]
        groups = {group: crew.members(group, with_extra=options.camera) for group in crew.GROUPS}
        if options.transport == "local":
            self._nodes += crew.make(chain.from_iterable(groups.values()), self._parameters())
        else:
            self._processes = [self._start(group, names) for group, names in groups.items()]
        if options.web is not None:
            self._nodes.append(_serve(options.web))
        for node in self._nodes:
            self._executor.add_node(node)

    def play(self, scenario: Scenario) -> int:
        """Spin until the scenario is over, and report how it went."""
        ended = self._executor.create_task(self._perform, scenario)
        problem, outcome = "", "done"
        try:
            for _ in self._turns():
                if ended.done():
                    break
            else:
                problem = f"not over after {_LIMIT:.0f} s"
            if ended.done():
                problem = ended.result()
        except KeyboardInterrupt:
            problem = _INTERRUPTED
        except _WindowClosedError:
            outcome = "window closed"
        except ScenarioError as error:
            problem = str(error)
        simulated, real = self._director.now - self._begun, time.monotonic() - self._started
        self._line.clear()
        self._summary(simulated, real, problem or outcome)
        recorded = True
        if self._recorder is not None and self._options.record is not None:
            recorded = self._record(self._recorder, self._options.record)
        if self._options.web is not None and problem != _INTERRUPTED:
            self._stay()
        if problem == _INTERRUPTED:
            return _CODE_INTERRUPTED
        return 1 if problem or self._director.score.falls or not recorded else 0

    def close(self) -> None:
        """End all nodes and processes."""
        for process in self._processes:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in self._processes:
            try:
                process.wait(_ENDING)
            except subprocess.TimeoutExpired:
                process.kill()
        for node in self._nodes:
            node.destroy_node()
        self._executor.shutdown()

    async def _perform(self, scenario: Scenario) -> str:
        """Play the scenario; returns what went wrong, or ""."""
        try:
            await self._director.ready()
            self._begun, self._started = self._director.now, time.monotonic()
            await scenario(self._director)
            self._hash = self._director.state_hash
        except ScenarioError as error:
            return str(error)
        return ""

    def _turns(self) -> Iterator[None]:
        end = time.monotonic() + _LIMIT
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=_LINE)
            self._line.show(self._director, self._started, self._begun)
            for process in self._processes:
                if process.poll() is not None:
                    raise ScenarioError(f"a part of the robot has ended with exit code {process.returncode}")
            self._look_at_window()
            yield

    def _open_window(self) -> Window | None:
        try:
            return Window(load_model(*self._options.model_parameters), self._options.model_parameters)
        except WindowError as error:
            print(f"warning: {error}", file=sys.stderr)
            return None

    def _look_at_window(self) -> None:
        """Check that the window is still open. Raises _WindowClosedError."""
        try:
            if self._window is not None and self._window.closed:
                raise _WindowClosedError
        except WindowError as error:
            self._line.clear()
            print(f"warning: {error}", file=sys.stderr)
            self._window = None

    def _say(self, what: str) -> None:
        self._line.clear()
        print(f"{self._director.now:7.2f} s  {what}", flush=True)

    def _stay(self) -> None:
        print("the page stays open: Ctrl-C ends")
        with contextlib.suppress(KeyboardInterrupt):
            while True:
                self._executor.spin_once(timeout_sec=_LINE)

    def _record(self, recorder: Recorder, path: Path) -> bool:
        """Write the pictures; returns whether that succeeded."""
        try:
            recorder.save(path)
        except (RenderingError, OSError) as error:
            print(f"error: {path} was not written: {error}", file=sys.stderr)
            return False
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")
        return True

    def _summary(self, simulated: float, real: float, outcome: str) -> None:
        score = self._director.score
        rows = [("scenario", self._options.scenario), ("outcome", outcome)]
        rows += [("simulated", f"{simulated:.1f} s"), ("real-time factor", f"{simulated / real:.2f}")]
        rows += [("steps", str(score.steps)), ("distance", f"{score.distance:.2f} m")]
        if score.foot_errors:
            rows.append(("foot error", f"{score.foot_error * 1e3:.1f} mm rms"))
        if score.goal_errors:
            rows.append(("goal error", f"{max(score.goal_errors) * 1e3:.0f} mm at most"))
        if score.dances:
            rows.append(("dances", str(score.dances)))
        if score.pushes:
            rows.append(("pushes", str(score.pushes)))
        if score.stop_times:
            rows.append(("stop after cancel", f"{max(score.stop_times):.2f} s at most"))
        rows.append(("falls", str(score.falls)))
        if self._hash and self._options.transport == "local":
            rows.append(("state hash", self._hash[:16]))
        width = max(len(name) for name, _ in rows)
        print()
        for name, value in rows:
            print(f"  {name:{width}}  {value}")

    def _parameters(self) -> dict[str, dict[str, Any]]:
        options = self._options
        simulator: dict[str, Any] = {"seed": options.seed, "noise": options.noise, "ground_truth": True}
        simulator["lockstep"] = not (options.realtime and options.transport != "local")
        if options.realtime or options.web is not None or self._window is not None:
            simulator["speed"] = 1.0
        if options.transport != "local":
            # On real rclpy a message costs each receiver a hundred microseconds, and every node receives the
            # clock.
            simulator["clock_period"] = simulator["ground_truth_period"] = 0.02
        # A machine may be busy, and processes start and are discovered one after another.
        simulator["patience"] = 5.0
        model_file, joint_map = options.model_parameters
        body = {"model_file": model_file, "joint_map": joint_map}
        return {**dict.fromkeys(_WITH_BODY, body), "simulator": {**simulator, **body}}

    def _start(self, group: str, names: tuple[str, ...]) -> subprocess.Popen[bytes]:
        """Start a group of nodes as a process of its own, with the paths of this one."""
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        command = [sys.executable, "-m", "humanoid.show.crew", json.dumps(self._parameters()), group, *names]
        # Its stdin ends when this process ends, however that happens.
        return subprocess.Popen(command, env=environment, stdin=subprocess.PIPE)


def _serve(port: int) -> Node:
    from .web.view_node import WebView  # its libraries take time to import

    try:
        view = WebView(port)
    except OSError as error:
        sys.exit(f"error: 127.0.0.1:{port}: {error.strerror}; choose another port with --port, or 0 for any")
    print(f"watch at {view.page.url}", flush=True)
    return view


class _ProgressLine:
    """One line on a terminal that is overwritten; nothing in a pipe.

    The cursor stays at its beginning, so that log lines of nodes overwrite it too.
    """

    def __init__(self) -> None:
        self._shown = 0.0
        self._open = False

    def show(self, director: Director, started: float, begun: float) -> None:
        now = time.monotonic()
        if not sys.stdout.isatty() or now - self._shown < _LINE:
            return
        self._shown, self._open = now, True
        if director.mode is Mode.UNKNOWN:
            text = "waiting for the nodes"
        else:
            mode = director.mode.name.lower().replace("_", " ")
            speed = (director.now - begun) / max(now - started, 1e-3)
            text = f"{director.now:7.2f} s  {mode}, {director.score.steps} steps, {speed:.1f}x real time"
        print(f"\r\x1b[K{text[:79]}\r", end="", flush=True)

    def clear(self) -> None:
        if self._open:
            print("\r\x1b[K", end="", flush=True)
            self._open = False
