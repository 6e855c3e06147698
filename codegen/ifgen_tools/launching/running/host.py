"""Runs a description: visits its entities, hands events to handlers, and ends everything in the end."""

from __future__ import annotations

import itertools
import logging
import shutil
import signal
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Any, Final

from ifgen_runtime.parameters import parameter_yaml
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from launch.action import Action
from launch.actions import ExecuteProcess
from launch.event import Event
from launch.events import ExecutionComplete, Shutdown
from launch.events.process import ShutdownProcess, SignalProcess
from launch.launch_context import ProcessToStart
from launch.utilities import perform_substitutions

from ifgen_tools.launching.errors import LaunchError, Place, explained
from ifgen_tools.launching.reading import read
from ifgen_tools.launching.reading.texts import parse
from ifgen_tools.launching.running.loop import Loop, TimedCall
from ifgen_tools.launching.running.output import LogHandler, Output
from ifgen_tools.launching.running.process import Warden
from ifgen_tools.launching.running.supervision import RUN, Supervision
from ifgen_tools.running import packages

_MAX_DEPTH: Final = 150
"""Entities within entities; more of them are files that include each other."""


class LaunchHost:
    """One launch: `output_folder` has the user's generated packages, `transport` is what nodes run on."""

    def __init__(self, context: LaunchContext, output_folder: Path, transport: str) -> None:
        self.context = context
        context.host = self
        self.loop = Loop()
        self.output = Output()
        self.warden = Warden()
        self.running: list[Supervision] = []
        self.exit_code = 0
        self._output_folder = output_folder
        self.transport = transport
        self._near: list[Path] = []
        self._depth = 0
        self._interruptions = 0
        self._files: tempfile.TemporaryDirectory[str] | None = None
        self._file_numbers = itertools.count()
        self._lifecycle: Any = None

    def run(self, description: LaunchDescriptionEntity) -> int:
        """Run a description to its end, and return the exit code."""
        handler = LogHandler(self.output)
        logger = logging.getLogger("launch")
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        before = {number: signal.signal(number, self._on_signal) for number in _ending_signals()}
        try:
            self.output.log("INFO", "launch", f"All log files can be found below {self.output.folder}")
            self.loop.post(lambda: self.visit([description]))
            self._run()
            return self.exit_code
        finally:
            for number, earlier in before.items():
                signal.signal(number, earlier)
            logger.removeHandler(handler)
            self.close()

    def close(self) -> None:
        """End what is left, and remove the temporary files."""
        for each in self.running:
            each.signal(getattr(signal, "SIGKILL", 9))
        self.warden.close()
        if self._lifecycle is not None:
            self._lifecycle.close()
        if self._files is not None:
            self._files.cleanup()
        self.output.close()

    def _run(self) -> None:
        is_idle = False
        while not (self.context.is_shutdown and is_idle):
            try:
                self.loop.step()
            except LaunchError as error:
                self.fail(error)
            except Exception as error:  # of a handler or of a condition that users wrote
                self.fail(explained(error))
            is_idle = not self.running and not self.loop.has_work()
            if is_idle and not self.context.is_shutdown:
                self._shut_down(Shutdown(reason="idle"))
                is_idle = False

    def fail(self, error: LaunchError) -> None:
        """Report an error of the description, and end the launch."""
        self.output.log("ERROR", "launch", error.message)
        if error.help:
            self.output.log("ERROR", "launch", f"  = help: {error.help}")
        self.exit_code = 1
        if not self.context.is_shutdown:
            self._shut_down(Shutdown(reason="an error in the launch description"))

    def visit(self, entities: Sequence[LaunchDescriptionEntity]) -> None:
        """Visit entities, and what they return, in their order. Raises LaunchError."""
        self._depth += 1
        try:
            for entity in entities:
                try:
                    following = entity.visit(self.context)
                except Exception as error:
                    raise explained(error, entity.place) from error
                if following and self._depth > _MAX_DEPTH:
                    raise LaunchError("launch files include each other without an end", entity.place)
                self.visit(following or ())
        finally:
            self._depth -= 1

    def emit(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""
        if isinstance(event, Shutdown):
            self.loop.post(lambda: None if self.context.is_shutdown else self._shut_down(event))
        else:
            self.loop.post(lambda: self.handle(event))

    def handle(self, event: Event) -> None:
        """Let the handlers have an event now. Raises LaunchError."""
        if isinstance(event, ShutdownProcess | SignalProcess):
            for each in tuple(self.running):
                if any(event.process_matcher(action) for action in each.actions):
                    self._reach(each, event)
        for handler in tuple(self.context.event_handlers):
            if handler.matches(event):
                self.context.push_locals()
                try:
                    self.visit(handler.handle(event, self.context))
                finally:
                    self.context.pop_locals()

    def _reach(self, process: Supervision, event: ShutdownProcess | SignalProcess) -> None:
        if isinstance(event, ShutdownProcess):
            process.stop(quietly=False)
            return
        name = process.plan.name
        self.output.log("INFO", name, f"sending signal '{event.signal_name}' to process[{name}]")
        process.signal(event.signal)

    def completed(self, action: Action) -> None:
        """Tell those who wait for the end of an action."""
        event = ExecutionComplete(action=action)
        if self.context.would_handle_event(event):
            self.emit(event)

    def later(self, seconds: float, call: Callable[[], None], *, until_shutdown: bool) -> TimedCall:
        """Make a call when so much time has passed, in the file that asks for it."""
        local = self.context.get_locals_as_dict()

        def make() -> None:
            self.context.push_locals()
            self.context.extend_locals(local)
            try:
                call()
            finally:
                self.context.pop_locals()

        return self.loop.later(seconds, make, until_shutdown=until_shutdown)

    def start(self, action: ExecuteProcess, process: ProcessToStart) -> None:
        """Start a process. Raises LaunchError."""
        self.supervise([action], process)

    def supervise(self, actions: list[ExecuteProcess], process: ProcessToStart) -> None:
        """Start the process of one action, or of several. Raises LaunchError."""
        supervision = Supervision(self, actions, process)
        supervision.start()
        self.running.append(supervision)

    def ended(self, process: Supervision) -> None:
        """Note that a process has come to its end, and is not respawned."""
        if process in self.running:
            self.running.remove(process)
        if process.is_stopping:  # a slow end must not hide what ended the launch
            self.exit_code = self.exit_code or process.failure
        else:
            self.exit_code = max(self.exit_code, process.failure)

    def _shut_down(self, event: Shutdown) -> None:
        self.context.is_shutdown = True
        self.loop.cancel_until_shutdown()
        try:
            self.handle(event)
        finally:
            for each in tuple(self.running):
                each.stop(quietly=event.due_to_sigint)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self.loop.post(lambda: self._interrupt(signal.Signals(number)))

    def _interrupt(self, number: signal.Signals) -> None:
        self._interruptions += 1
        if self._interruptions == 1:
            if number == signal.SIGINT:
                text = "user interrupted with ctrl-c (SIGINT)"
            else:
                text = f"ended by {number.name}"
                self.exit_code = max(self.exit_code, 128 + number)
            self.output.log("WARNING", "launch", text)
            if not self.context.is_shutdown:
                self._shut_down(Shutdown(reason=text, due_to_sigint=True))
            return
        harder = signal.SIGTERM if self._interruptions == 2 else getattr(signal, "SIGKILL", 9)
        self.output.log(
            "WARNING", "launch", f"interrupted again: sending signal {int(harder)} to all processes"
        )
        for each in tuple(self.running):
            each.signal(harder)

    # What descriptions ask for, besides.

    def read(self, path: str) -> LaunchDescription:
        """Return the description in a launch file. Raises LaunchError.

        It can import the modules of packages that are sources, as if they were installed, and ask
        `ament_index_python` for their shared files.
        """
        self._near.append(Path(path).absolute())
        folders = map(str, packages.source_folders(self._near))
        sys.path += [folder for folder in folders if folder not in sys.path]
        return read(path)

    def share(self, package: str) -> str:
        """Return the folder of shared files of a package. Raises LaunchError."""
        return str(self._package(package).share)

    def prefix(self, package: str) -> str:
        """Return the folder that a package is installed in. Raises LaunchError."""
        found = self._package(package)
        if found.prefix is None:
            raise LaunchError(f"the package '{package}' is not installed: its files are in {found.share}")
        return str(found.prefix)

    def _package(self, name: str) -> packages.Package:
        found = packages.find(name, self._output_folder, self._near)
        if found is None:
            diagnostic = packages.missing(name, self._output_folder)
            raise LaunchError(diagnostic.message, help=diagnostic.help or "")
        return found

    def executable(self, package: str, name: str) -> Sequence[str]:
        """Return the command of an executable of a package. Raises UsageError."""
        return self._command(packages.executable(package, name, self._output_folder, self._near))

    def program(self, path: str) -> Sequence[str]:
        """Return the command of a program: a file, beside the launch file too, or one on PATH."""
        beside = [near.parent / path for near in reversed(self._near)]
        for file in (Path(path), *beside):
            if file.is_file():
                return self._command(packages.Executable(file.name, (str(file),), packages.is_python(file)))
        return [shutil.which(path, path=self.context.environment.get("PATH")) or path]

    def _command(self, found: packages.Executable) -> list[str]:
        if not found.is_python:
            return list(found.words)
        return [*RUN, "--of-launch", "--transport", self.transport, *found.words]

    def parameter_file(self, parameters: Mapping[str, Any], node: str) -> str:
        """Write parameters of a node to a file that is there as long as the launch is."""
        for name, value in parameters.items():
            if isinstance(value, bytes):
                raise LaunchError(f"the parameter '{name}' is bytes, which no parameter file can hold")
            if parameter_yaml.is_beyond_files(value):
                self.output.log(
                    "WARNING",
                    "launch",
                    f"the parameter '{name}' is an empty list, which no parameter file can hold: "
                    "the node keeps its default value",
                )
        return self.text_file(parameter_yaml.file_text(node, parameters))

    def text_file(self, text: str) -> str:
        """Write a text to a file that is there as long as the launch is."""
        path = self.new_file("text.yaml")
        Path(path).write_text(text, encoding="utf-8")
        return path

    def new_file(self, name: str) -> str:
        """Return the path of a file that nobody else has; what is written there goes with the launch."""
        if self._files is None:
            self._files = tempfile.TemporaryDirectory(prefix="ifgen-launch-")
        return str(Path(self._files.name) / f"{next(self._file_numbers)}-{name}")

    def fill(self, text: str, path: str) -> str:
        """Return the text of a file with its substitutions performed. Raises LaunchError."""
        filled: list[str] = []
        for number, line in enumerate(text.splitlines(keepends=True), 1):
            place: Place = (path, number)
            try:
                filled.append(
                    perform_substitutions(self.context, parse(line, place)) if "$(" in line else line
                )
            except Exception as error:
                raise explained(error, place) from error
        return "".join(filled)

    def change_state(self, node_name: str, transition_id: int) -> None:
        """Ask a managed node for a transition."""
        self._managed().change(node_name, transition_id)

    def watch_state(self, node_name: str, call: Callable[[Any], None]) -> None:
        """Call with each transition of a managed node."""
        self._managed().watch(node_name, call)

    def _managed(self) -> Any:
        if self._lifecycle is None:
            from ifgen_tools.launching.running.lifecycle import (
                Lifecycle,
            )  # imports an rclpy, which few launches need

            self._lifecycle = Lifecycle(self.loop.post, self.output.log)
        return self._lifecycle

    def log(self, level: str, name: str, text: str) -> None:
        """Print a line about the launch."""
        self.output.log(level, name, text)

    @property
    def log_directory(self) -> str:
        """The folder of the log files of this launch."""
        return str(self.output.folder)


def _ending_signals() -> list[signal.Signals]:
    names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    found = [getattr(signal, name) for name in names if hasattr(signal, name)]
    return [number for number in found if signal.getsignal(number) is not signal.SIG_IGN]
