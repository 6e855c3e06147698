"""All nodes of a launch in one process: those that start with it, and are programs in Python."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

from launch import LaunchContext
from launch.actions import ExecuteProcess
from launch.launch_context import ProcessToStart
from launch_ros.actions import Node

from ifgen_tools.launching.errors import LaunchError
from ifgen_tools.launching.running.host import LaunchHost
from ifgen_tools.launching.running.supervision import RUN

_NAME: Final = "nodes-1"


class TogetherHost(LaunchHost):
    """A launch whose nodes wait for each other, and start as one process."""

    def __init__(self, context: LaunchContext, output_folder: Path, transport: str) -> None:
        super().__init__(context, output_folder, transport)
        self._waiting: list[tuple[Node, ProcessToStart]] = []
        self._has_started = False

    def start(self, action: ExecuteProcess, process: ProcessToStart) -> None:
        """Start a process, or let a node wait for the others. Raises LaunchError for one that cannot."""
        if not isinstance(action, Node):
            super().start(action, process)
            return
        if reason := self._reason_against(process):
            raise LaunchError(f"{action.describe()} cannot run with --one-process: {reason}", action.place)
        if not self._waiting:
            self.loop.post(self._start_all)
        self._waiting.append((action, process))

    def _reason_against(self, process: ProcessToStart) -> str:
        if self._has_started:
            return "it starts later than the others"
        if list(process.command[: len(self._python())]) != self._python():
            return "it is no program in Python, or has a prefix"
        if process.respawn:
            return "it is respawned"
        if process.shell or process.emulate_tty or process.cwd is not None:
            return "it has a shell, a terminal or a working folder of its own"
        if self._waiting and process.env != self._waiting[0][1].env:
            return "its environment is not that of the others"
        return ""

    def _python(self) -> list[str]:
        return [*RUN, "--of-launch", "--transport", self.transport]

    def _start_all(self) -> None:
        self._has_started = True
        words: list[str] = []
        for _, process in self._waiting:
            words += [*([":"] if words else []), *process.command[len(self._python()) :]]
        first = self._waiting[0][1]
        together = replace(
            first,
            name=_NAME,
            command=[*self._python(), "--until-all-end", *words],
            stdout=frozenset().union(*(process.stdout for _, process in self._waiting)),
            stderr=frozenset().union(*(process.stderr for _, process in self._waiting)),
        )
        self.supervise([node for node, _ in self._waiting], together)
