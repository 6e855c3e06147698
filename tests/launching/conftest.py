"""Launch files, and launches that start nothing."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from ifgen import resources

sys.path.append(str(resources.libraries()))  # where `ifgen launch` finds `launch`

from ifgen_tools.launching.running.host import LaunchHost
from launch import LaunchContext
from launch.actions import ExecuteProcess, IncludeLaunchDescription
from launch.launch_context import ProcessToStart


class Recorder(LaunchHost):
    """A launch that notes what it would start, and says that it has ended at once."""

    def __init__(self, context: LaunchContext) -> None:
        super().__init__(context, Path("generated").resolve(), "local")
        self.started: list[ProcessToStart] = []
        self.said: list[str] = []

    def supervise(self, actions: list[ExecuteProcess], process: ProcessToStart) -> None:
        self.started.append(process)

    def log(self, level: str, name: str, text: str) -> None:
        self.said.append(text)


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
        recorder = Recorder(LaunchContext())
        include = IncludeLaunchDescription(str(file), launch_arguments=list(arguments.items()))
        include.place = None  # as that of the command line
        recorder.run(include)
        return recorder

    return run
