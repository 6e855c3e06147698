"""Launch files, and launches that start nothing."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from ifgen import resources

sys.path.append(str(resources.libraries()))  # where `ifgen launch` finds `launch`

from ifgen_tools.launching.packages import UserPackages
from launch import LaunchDescription, LaunchService
from launch import logging as launch_logging
from launch.actions import ExecuteLocal, IncludeLaunchDescription
from launch.launch_context import ProcessToStart


class Recorder(LaunchService):
    """A launch that notes what it would start, and says that it has ended at once."""

    def __init__(self) -> None:
        launch_logging.reset()
        super().__init__()
        self.context.packages = UserPackages(Path("generated").resolve(), "local")
        self.started: list[ProcessToStart] = []
        self.said: list[str] = []
        for name in (
            None,
            "launch.user",
            "launch_ros.actions.node",
            "launch_ros.actions.composable_node_container",
        ):
            launch_logging.get_logger(name).addHandler(Said(self.said))

    def start(self, actions: Sequence[ExecuteLocal], process: ProcessToStart) -> None:
        self.started.append(process)


class Said(logging.Handler):
    """Collects what a launch says of its own."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__()
        self._lines = lines

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno < logging.ERROR and not record.getMessage().startswith("All log files"):
            self._lines.append(record.getMessage())


Recorded = Callable[..., Recorder]


@pytest.fixture(autouse=True)
def log_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))
    before = dict(os.environ)
    yield
    os.environ.clear()
    os.environ.update(before)


@pytest.fixture
def record(tmp_path: Path) -> Recorded:
    """Run a launch file, given as its name and its text, with arguments; return what it started and said."""

    def run(name: str, text: str, **arguments: str) -> Recorder:
        file = tmp_path / name
        file.write_text(text)
        recorder = Recorder()
        include = IncludeLaunchDescription(str(file), launch_arguments=list(arguments.items()))
        include.place = None  # as that of the command line
        recorder.include_launch_description(LaunchDescription([include]))
        recorder.run()
        return recorder

    return run
