"""The surroundings of a description that runs: its state, and three that serve it.

`host` runs it, `packages` finds packages and programs, and `files` keeps files for the time of the launch.
"""

from __future__ import annotations

import asyncio
import itertools
import os
import tempfile
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Protocol

from launch._packages import InstalledPackages

if TYPE_CHECKING:
    from launch.action import Action
    from launch.actions import ExecuteLocal
    from launch.event import Event
    from launch.event_handler import BaseEventHandler
    from launch.substitution import Substitution


@dataclass(frozen=True, slots=True)
class ProcessToStart:
    """A process as its action describes it, with all substitutions performed."""

    name: str
    command: Sequence[str]
    cwd: str | None
    env: Mapping[str, str]
    stdout: frozenset[str]
    """Where its lines go: `screen`, `log` (the common file) and `own_log`."""
    stderr: frozenset[str]
    sigterm_timeout: float
    """Seconds between SIGINT and SIGTERM."""
    sigkill_timeout: float
    """Seconds between SIGTERM and SIGKILL."""
    shell: bool = False
    emulate_tty: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    respawn_max_retries: int = -1


class Timer(Protocol):
    """A call that is still to come."""

    def cancel(self) -> None:
        """Do not make it."""

    def fire(self) -> None:
        """Make it now, unless it was made or cancelled."""


class Host(Protocol):
    """Runs a description in one thread: `LaunchService`."""

    def post(self, call: Callable[[], None]) -> None:
        """Make a call after what is going on; from any thread."""

    def later(self, seconds: float | None, call: Callable[[], None], *, until_shutdown: bool) -> Timer:
        """Make a call when so much time has passed; None: when it is fired."""
        ...

    def at_end(self, call: Callable[[], None]) -> None:
        """Make a call when the launch is over."""

    def visit(self, entities: Sequence[Any]) -> None:
        """Visit entities now."""

    def emit(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""

    def handle(self, event: Event) -> None:
        """Let the handlers have an event now."""

    def completed(self, action: Action) -> None:
        """Note that an action has come to its end."""

    def start(self, actions: Sequence[ExecuteLocal], process: ProcessToStart) -> None:
        """Start a process, and emit the events of its life to each of these actions."""


@dataclass(frozen=True, slots=True)
class Start:
    """How a program starts that `ifgen run` runs, and how it hears that nobody waits for it any more."""

    environment: Mapping[str, str]
    during: AbstractContextManager[None]
    dismiss: Callable[[], None]


class Packages(Protocol):
    """Finds packages and programs."""

    def near(self, path: str) -> None:
        """Note that a launch file is read: what is beside it can be found."""

    def share(self, package: str) -> str:
        """Return the folder of shared files of a package."""
        ...

    def prefix(self, package: str) -> str:
        """Return the folder that a package is installed in."""
        ...

    def executable(self, package: str, name: str) -> Sequence[str]:
        """Return the command of an executable of a package."""
        ...

    def program(self, path: str, search: str | None) -> Sequence[str]:
        """Return the command of a program that is named by its file, or found in a list of folders."""
        ...

    def start(self, command: Sequence[str], files: Files) -> Start | None:
        """Return how to start a command if it is `ifgen run`; else None."""
        ...


class Files:
    """Files that are there as long as the launch is."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._numbers = itertools.count()

    def new(self, name: str) -> str:
        """Return the path of a file that nobody else has."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="ifgen-launch-")
        return str(Path(self._folder.name) / f"{next(self._numbers)}-{name}")

    def text(self, text: str, name: str = "text.yaml") -> str:
        """Write a text to a file, and return its path."""
        path = self.new(name)
        Path(path).write_text(text, encoding="utf-8")
        return path

    def close(self) -> None:
        """Remove them."""
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None


class LaunchContext:
    """The state of a launch that substitutions read and actions change."""

    def __init__(self, *, argv: Sequence[str] | None = None, noninteractive: bool = False) -> None:
        self.argv: list[str] = list(argv or ())
        self.noninteractive = noninteractive
        self.launch_configurations: dict[str, Any] = {}
        self.environment: MutableMapping[str, str] = os.environ
        self.is_shutdown = False
        self.runs_programs = True
        """Whether `Command` runs: not where a description is only checked."""
        self.runs_python = True
        """Whether `PythonExpression` runs."""
        self.event_handlers: list[BaseEventHandler] = []
        self.packages: Packages = InstalledPackages()
        self.files = Files()
        self.asyncio_loop: asyncio.AbstractEventLoop | None = None
        self._host: Host | None = None
        self._globals: dict[str, Any] = {}
        self._completions: list[asyncio.Future[Any]] = []
        self._locals: dict[str, Any] = {}
        self._stack: list[dict[str, Any]] = []
        self._configurations: list[dict[str, Any]] = []
        self._environments: list[dict[str, str]] = []

    @property
    def host(self) -> Host:
        """The one that runs the description. Raises RuntimeError where nobody does."""
        if self._host is None:
            raise RuntimeError(
                "this context belongs to no launch: `ifgen launch FILE` and LaunchService make one that does"
            )
        return self._host

    @host.setter
    def host(self, host: Host) -> None:
        self._host = host

    @property
    def locals(self) -> SimpleNamespace:
        """The values of the event that is handled, such as `event`, and of the file that is visited."""
        return SimpleNamespace(**self.get_locals_as_dict())

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return the locals by name, and the globals that they do not hide."""
        return {**self._globals, **self._locals}

    def get_locals(self) -> dict[str, Any]:
        """Return the locals by name, without the globals."""
        return dict(self._locals)

    def get_globals_as_dict(self) -> dict[str, Any]:
        """Return the globals by name."""
        return dict(self._globals)

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Add locals, or replace those of these names."""
        self._locals.update(extensions)

    def extend_globals(self, extensions: Mapping[str, Any]) -> None:
        """Add what stays when an event has been handled. Raises RuntimeError for what a local hides."""
        for name in extensions.keys() & self._locals.keys():
            raise RuntimeError(f"a global '{name}' would be hidden by the local of this name")
        self._globals.update(extensions)

    def remove_locals(self, *names: str) -> None:
        """Remove locals that may be there."""
        for name in names:
            self._locals.pop(name, None)

    def push_locals(self) -> None:
        """Keep the locals for `pop_locals`."""
        self._stack.append(dict(self._locals))

    def pop_locals(self) -> None:
        """Return to the locals of the last `push_locals`."""
        self._locals = self._stack.pop()

    def push_launch_configurations(self) -> None:
        """Keep the configurations for `pop_launch_configurations`."""
        self._configurations.append(dict(self.launch_configurations))

    def pop_launch_configurations(self) -> None:
        """Return to the configurations of the last `push_launch_configurations`."""
        before = self._configurations.pop()
        self.launch_configurations.clear()
        self.launch_configurations.update(before)

    def push_environment(self) -> None:
        """Keep the environment for `pop_environment`."""
        self._environments.append(dict(self.environment))

    def pop_environment(self) -> None:
        """Return to the environment of the last `push_environment`."""
        self.set_environment(self._environments.pop())

    def set_environment(self, variables: Mapping[str, str]) -> None:
        """Replace the whole environment."""
        for name in self.environment.keys() - variables.keys():
            del self.environment[name]
        self.environment.update(variables)

    def perform_substitution(self, substitution: Substitution) -> str:
        """Return the text of a substitution."""
        return substitution.perform(self)

    def register_event_handler(self, event_handler: BaseEventHandler, append: bool = False) -> None:
        """Add a handler before all others, or after them."""
        self.event_handlers.insert(len(self.event_handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: BaseEventHandler) -> None:
        """Remove a handler. Raises ValueError if it is not there."""
        self.event_handlers.remove(event_handler)

    def would_handle_event(self, event: Event) -> bool:
        """Return whether a handler matches an event."""
        return any(handler.matches(event) for handler in self.event_handlers)

    def emit_event_sync(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""
        self.host.emit(event)

    async def emit_event(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""
        self.host.emit(event)

    def add_completion_future(self, completion_future: asyncio.Future[Any]) -> None:
        """Keep the launch alive until a future is done."""
        self._completions = [*self.pending_futures(), completion_future]
        completion_future.add_done_callback(lambda _: self.host.post(lambda: None))  # it may be the last one

    def pending_futures(self) -> list[asyncio.Future[Any]]:
        """Return the futures that keep the launch alive."""
        return [future for future in self._completions if not future.done()]
