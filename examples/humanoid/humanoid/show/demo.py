"""The demo: starts the nodes, plays a scenario, and reports how it went. `ifgen demo` calls `main`."""

from __future__ import annotations

import contextlib
import json
import math
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from types import FrameType
from typing import Any

import rclpy
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

from ..data import Mode
from ..robot.external import load_model
from ..robot.table import ModelError
from ..ros.messages import printable
from ..simulation.rendering import RenderingError, check
from . import crew, parts, report
from .audience import Audience, AudienceError
from .director import Director
from .pictures import check_format
from .recorder import Recorder, check_writable
from .replacing import ReplacementError, checked, split
from .scenarios import ScenarioFileError, needs_eyes, read
from .window import Window, WindowError, display

_LIMIT = 600.0  # s of real time for a scenario
_TURN = 0.1  # s of real time between checks of windows and processes
_DISCOVERY = 0.7  # s that DDS has to find another robot
_INTERRUPTED = "interrupted"
_CODE_INTERRUPTED = 130  # as for all commands of ifgen
_CODE_TERMINATED = 143


class _TerminatedError(KeyboardInterrupt):
    """SIGTERM came: it ends everything as Ctrl-C does, with its own exit code."""


class _WindowClosedError(Exception):
    """The user has closed the window."""


class _CompanyError(Exception):
    """Another robot is there; the text says what to do."""


class _PartEndedError(Exception):
    """A process of the robot has ended; the text says how."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options of the command line."""

    scenario: str = "all"
    idle: bool = False  # no scenario: the robot stands, and waits for others
    without: tuple[str, ...] = ()
    replace: tuple[str, ...] = ()  # NODE=FILE_OR_MODULE, each
    transport: str = "local"
    record: Path | None = None
    web: int | None = None  # the port; 0: any free one
    host: str = ""  # another address than this machine's own
    window: bool = False  # if there is a display
    realtime: bool = False
    seed: int = 0
    noise: bool = True
    camera: bool | None = None  # None: where time waits for the pictures, or a scenario needs them
    model: Path | None = None
    joint_map: Path | None = None

    @property
    def sees(self) -> bool:
        """Whether the robot sees."""
        return self.transport == "local" if self.camera is None else self.camera

    @property
    def model_parameters(self) -> tuple[str, str]:
        """The parameters `model_file` and `joint_map` of the nodes that know the robot's body."""
        paths = (self.model, self.joint_map)
        return str(paths[0].resolve()) if paths[0] else "", str(paths[1].resolve()) if paths[1] else ""


def main(options: Options) -> int:
    """Play a scenario; the exit code is 0 if the robot did what it was asked to and did not fall."""
    try:
        load_model(*options.model_parameters)  # its errors should be reported before nodes start
        if options.record is not None:
            check_writable(options.record)
            check_format(options.record)
            check()
    except (ModelError, RenderingError) as error:
        sys.exit(f"error: {error}")
    # Ctrl-C and SIGTERM end the scenario; the summary is still printed.
    signal.signal(signal.SIGTERM, _terminate)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        show = _Show(options)
    except (ScenarioFileError, AudienceError, ReplacementError, _CompanyError) as error:
        rclpy.try_shutdown()
        sys.exit(f"error: {error}")
    try:
        return show.play()
    finally:
        show.close()
        rclpy.try_shutdown()


def _terminate(number: int, frame: FrameType | None) -> None:
    raise _TerminatedError


class _Show:
    """Everything that runs while a scenario is played."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._name = "idle" if options.idle else Path(options.scenario).stem
        self._scenario = {} if options.idle else read(options.scenario)
        self._sees = options.sees or (options.camera is None and needs_eyes(self._scenario))
        self._started: float | None = None  # when the first task began, real time
        self._has_invited = False
        self._line = report.ProgressLine()
        self._processes: list[subprocess.Popen[bytes]] = []
        self._executor: Executor = SingleThreadedExecutor()
        overrides = [Parameter(k, value=v) for k, v in self._scenario.get("audience", {}).items()]
        audience = Audience(parameter_overrides=[Parameter("use_sim_time", value=True), *overrides])
        self._audience = audience
        self._director = Director(self._say, lambda: audience.is_over)
        self._recorder = self._record_to(options.record) if options.record else None
        self._window = self._open_window() if options.window and display() else None
        if options.window and not display() and not options.record:
            print("no display for a window: see the robot with --web or --record FILE.gif", flush=True)
        known = crew.all_nodes()
        self._without = {checked(name, known) for name in options.without}
        self._replaced = dict(split(text, known) for text in options.replace)
        shown = (self._director, audience, self._recorder, self._window)
        self._nodes: list[Node] = [node for node in shown if node]
        groups = {group: self._members(group) for group in crew.GROUPS}
        if options.transport == "local":
            # The simulator last, so that everybody hears its first readings, and nobody waits for others.
            physics = groups.pop(crew.PHYSICS)
            self._nodes += crew.make(chain(*reversed(groups.values())), self._parameters(), self._replaced)
            self._refuse_company(physics)  # before its first readings reach another robot
            self._nodes += crew.make(physics, self._parameters(), self._replaced)
        else:
            time.sleep(_DISCOVERY)
            self._refuse_company(groups[crew.PHYSICS])
            documents = [json.dumps(self._parameters()), json.dumps(self._replaced)]
            started = (parts.start([*documents, group, *names]) for group, names in groups.items())
            self._processes = list(started)
        if options.web is not None:
            self._nodes.append(_serve(options, audience))
        for node in self._nodes:
            self._executor.add_node(node)

    def _refuse_company(self, physics: tuple[str, ...]) -> None:
        """Refuse to run beside another robot: both would hear each other. Raises _CompanyError."""
        if self._director.count_publishers("/clock") > (0 if physics else 1):
            domain = self._director.context.get_domain_id()
            raise _CompanyError(
                f"another simulation runs in ROS domain {domain}: end it, or choose another domain, such as "
                f"ROS_DOMAIN_ID={domain % 100 + 1}"
            )

    def _members(self, group: str) -> tuple[str, ...]:
        names = crew.members(group, with_extra=self._sees)
        return tuple(name for name in names if name not in self._without)

    def play(self) -> int:
        """Spin until the scenario is over, and report how it went."""
        problem, outcome, code = "", "done", 0
        try:
            for _ in self._turns():
                if self._director.is_over and not self._options.idle:
                    problem = "; ".join(dict.fromkeys(self._director.score.failures))
                    break
            else:
                problem = f"not over after {_LIMIT:.0f} s"
        except KeyboardInterrupt as error:
            problem = _INTERRUPTED
            code = _CODE_TERMINATED if isinstance(error, _TerminatedError) else _CODE_INTERRUPTED
        except _WindowClosedError:
            outcome = "window closed"
        except _PartEndedError as error:
            problem = str(error)
        self._line.clear()
        self._summary(problem or outcome)
        recorded = True
        if self._recorder is not None and self._options.record is not None:
            recorded = self._record(self._recorder, self._options.record)
        if self._options.web is not None and not code:
            self._stay()
        if code:
            return code
        return 1 if problem or self._director.score.falls or not recorded else 0

    def close(self) -> None:
        """End all nodes and processes."""
        parts.end(self._processes)
        for node in self._nodes:
            node.destroy_node()
        self._executor.shutdown()

    def _turns(self) -> Iterator[None]:
        end = time.monotonic() + (math.inf if self._options.idle else _LIMIT)
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=_TURN)
            if (self._started is None) is not (self._director.begun is None):
                self._started = None if self._director.begun is None else time.monotonic()
            self._line.show(self._director, self._started or time.monotonic())
            for process in self._processes:
                if process.poll() is not None:
                    code = process.returncode
                    raise _PartEndedError(f"a part of the robot has ended with exit code {code}")
            self._look_at_window()
            self._invite()
            yield

    def _invite(self) -> None:
        """Say once that a robot without a scenario is ready for others."""
        if self._options.idle and not self._has_invited and self._director.mode is Mode.STANDING:
            self._has_invited = True
            domain = self._director.context.get_domain_id()
            self._line.clear()
            print(f"the robot stands, and waits for others in ROS domain {domain}: Ctrl-C ends", flush=True)

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
        print(f"{self._director.now:7.2f} s  {printable(what)}", flush=True)

    def _stay(self) -> None:
        print("the page stays open: Ctrl-C ends", flush=True)
        self._audience.let_go()
        with contextlib.suppress(KeyboardInterrupt):
            while True:
                self._executor.spin_once(timeout_sec=_TURN)

    def _record_to(self, path: Path) -> Recorder:
        return Recorder(load_model(*self._options.model_parameters), path)

    def _record(self, recorder: Recorder, path: Path) -> bool:
        """Write the pictures; returns whether that succeeded."""
        try:
            recorder.save(self._line.draws)
        except (RenderingError, OSError) as error:
            print(f"error: {path} was not written: {error}", file=sys.stderr)
            return False
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")
        return True

    def _summary(self, outcome: str) -> None:
        director = self._director
        simulated = director.now - (director.begun or 0.0)
        real = 0.0 if self._started is None else time.monotonic() - self._started
        rows = report.summary(self._name, outcome, simulated, real, director.score)
        if director.is_over and self._options.transport == "local":
            repeats = director.repeats and not self._without
            rows["state hash"] = (
                director.state_hash[:16]
                if repeats
                else "not reproducible: "
                + ("nodes outside this process" if director.repeats else "time went on without set-points")
            )
        report.show(rows)

    def _parameters(self) -> dict[str, dict[str, Any]]:
        options = self._options
        simulator: dict[str, Any] = {"seed": options.seed, "noise": options.noise, "ground_truth": True}
        simulator["lockstep"] = not (options.realtime and options.transport != "local")
        if options.realtime or options.web is not None or self._window is not None:
            simulator["speed"] = 1.0
        if options.transport != "local":
            # On real rclpy a message costs each receiver a hundred microseconds, and every node receives the
            # clock.
            simulator["ground_truth_period"] = 0.02
        # A machine may be busy, and processes start and are discovered one after another.
        simulator["patience"] = 5.0
        model_file, joint_map = options.model_parameters
        body = {"model_file": model_file, "joint_map": joint_map}
        parameters = {**dict.fromkeys(crew.WITH_BODY, body), crew.SIMULATOR: {**simulator, **body}}
        parameters["camera_driver"] = {"streaming": self._sees}
        for node, values in self._scenario.items():
            parameters[node] = {**parameters.get(node, {}), **values}
        return parameters


def _serve(options: Options, audience: Audience) -> Node:
    # Their libraries take time to import.
    from .web.server import LOOPBACK
    from .web.view_node import WebView

    host, port = options.host or LOOPBACK, options.web or 0
    try:
        view = WebView(port, host, audience, "" if options.idle else options.scenario)
    except OSError as error:
        sys.exit(f"error: {host}:{port}: {error.strerror}; choose another port with --port, or 0 for any")
    print(f"watch at {view.page.url}", flush=True)
    return view
