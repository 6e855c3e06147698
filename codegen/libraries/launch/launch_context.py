"""The surroundings of a description that runs: configurations, environment, handlers, and who runs it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from launch.action import Action
    from launch.actions import ExecuteProcess
    from launch.event import Event
    from launch.event_handler import EventHandler
    from launch.launch_description import LaunchDescription
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


class Host(Protocol):
    """Runs descriptions: `ifgen launch`."""

    def start(self, action: ExecuteProcess, process: ProcessToStart) -> None:
        """Start a process, and emit the events of its life."""

    def emit(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""

    def completed(self, action: Action) -> None:
        """Note that an action has come to its end."""

    def later(self, seconds: float, call: Callable[[], None], *, until_shutdown: bool) -> Timer:
        """Make a call when so much time has passed."""
        ...

    def visit(self, entities: Sequence[Any]) -> None:
        """Visit entities now."""

    def read(self, path: str) -> LaunchDescription:
        """Return the description in a launch file: Python, XML or YAML."""
        ...

    def share(self, package: str) -> str:
        """Return the folder of shared files of a package."""
        ...

    def prefix(self, package: str) -> str:
        """Return the folder that a package is installed in."""
        ...

    def executable(self, package: str, name: str) -> Sequence[str]:
        """Return the command of an executable of a package."""
        ...

    def program(self, path: str) -> Sequence[str]:
        """Return the command of a program that is named by its file, or found on PATH."""
        ...

    def parameter_file(self, parameters: Mapping[str, Any], node: str) -> str:
        """Write parameters of a node to a file, and return its path."""
        ...

    def text_file(self, text: str) -> str:
        """Write a text to a file that is there as long as the launch is, and return its path."""
        ...

    def fill(self, text: str, path: str) -> str:
        """Return the text of a file with its substitutions, such as `$(var x)`, performed."""
        ...

    def change_state(self, node_name: str, transition_id: int) -> None:
        """Ask a managed node for a transition."""

    def watch_state(self, node_name: str, call: Callable[[Any], None]) -> None:
        """Call with each `TransitionEvent` of a managed node."""

    def log(self, level: str, name: str, text: str) -> None:
        """Print a line about the launch: its level, such as INFO, and whom it is about."""

    @property
    def log_directory(self) -> str:
        """The folder of the log files of this launch."""
        ...


class LaunchContext:
    """The state of a launch that substitutions read and actions change."""

    def __init__(self, *, argv: Sequence[str] | None = None, noninteractive: bool = False) -> None:
        self.argv: list[str] = list(argv or ())
        self.noninteractive = noninteractive
        self.launch_configurations: dict[str, Any] = {}
        self.environment: MutableMapping[str, str] = os.environ
        self.is_shutdown = False
        self.event_handlers: list[EventHandler] = []
        self._host: Host | None = None
        self._locals: dict[str, Any] = {}
        self._stack: list[dict[str, Any]] = []
        self._configurations: list[dict[str, Any]] = []
        self._environments: list[dict[str, str]] = []

    @property
    def host(self) -> Host:
        """The one that runs the description. Raises RuntimeError where nobody does."""
        if self._host is None:
            raise RuntimeError("this context belongs to no launch: `ifgen launch FILE` makes one that does")
        return self._host

    @host.setter
    def host(self, host: Host) -> None:
        self._host = host

    @property
    def locals(self) -> SimpleNamespace:
        """The values of the event that is handled, such as `event`, and of the file that is visited."""
        return SimpleNamespace(**self._locals)

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return the locals by name."""
        return dict(self._locals)

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Add locals, or replace those of these names."""
        self._locals.update(extensions)

    def extend_globals(self, extensions: Mapping[str, Any]) -> None:
        """Add what stays when an event has been handled."""
        for names in (self._locals, *self._stack):
            names.update(extensions)

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

    def register_event_handler(self, event_handler: EventHandler, append: bool = False) -> None:
        """Add a handler before all others, or after them."""
        self.event_handlers.insert(len(self.event_handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: EventHandler) -> None:
        """Remove a handler. Raises ValueError if it is not there."""
        self.event_handlers.remove(event_handler)

    def would_handle_event(self, event: Event) -> bool:
        """Return whether a handler matches an event."""
        return any(handler.matches(event) for handler in self.event_handlers)

    def emit_event_sync(self, event: Event) -> None:
        """Let the handlers have an event, after what is going on."""
        self.host.emit(event)
