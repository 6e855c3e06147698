"""Processes."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any

from launch.action import Action
from launch.actions._outputs import places_of
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.event_handler import as_list
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
from launch.launch_context import LaunchContext, ProcessToStart
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_entities_type import SomeEntitiesType
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions import LaunchConfiguration
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions, performed

_numbers = count(1)


class ExecuteProcess(Action):
    """A process: its command, each word a text or a list of substitutions, and what belongs to it.

    `output` says where its lines go (screen, log, both, own_log, full, or a dict by stream). `respawn` starts
    it again when it ends. At a shutdown it gets SIGINT, after `sigterm_timeout` [s] SIGTERM, and after
    `sigkill_timeout` [s] more SIGKILL.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        additional_env: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        shell: bool | SomeSubstitutionsType = False,
        sigterm_timeout: SomeSubstitutionsType | None = None,
        sigkill_timeout: SomeSubstitutionsType | None = None,
        emulate_tty: bool | SomeSubstitutionsType = False,
        output: SomeSubstitutionsType | Mapping[str, Any] = "log",
        log_cmd: bool = False,
        on_exit: SomeEntitiesType
        | Callable[[ProcessExited, LaunchContext], SomeEntitiesType | None]
        | None = None,
        respawn: bool | SomeSubstitutionsType = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.cmd = [normalize_to_list_of_substitutions(word) for word in cmd]
        self.prefix = prefix
        self.name = name
        self.cwd = cwd
        self.env = env
        self.additional_env = additional_env
        self.shell = shell
        self.sigterm_timeout = sigterm_timeout or LaunchConfiguration("sigterm_timeout", default=5)
        self.sigkill_timeout = sigkill_timeout or LaunchConfiguration("sigkill_timeout", default=5)
        self.emulate_tty = emulate_tty
        self.output = output
        self.log_cmd = log_cmd
        self.on_exit = on_exit
        self.respawn = respawn
        self.respawn_delay = respawn_delay
        self.respawn_max_retries = respawn_max_retries
        self.process_details: dict[str, Any] | None = None
        self.return_code: int | None = None
        self._executed = False

    def describe(self) -> str:
        """Return its command."""
        words = (" ".join(each.describe() for each in word) for word in self.cmd)
        return f"{type(self).__name__}({' '.join(words)})"

    def describe_conditional_sub_entities(self) -> Sequence[tuple[str, Sequence[LaunchDescriptionEntity]]]:
        """Return what is done when it ends, as far as that is known."""
        return [] if self.on_exit is None or callable(self.on_exit) else [("on exit", as_list(self.on_exit))]

    def ends_later(self) -> bool:
        """Return True: it goes on until its process has ended."""
        return True

    def execute(self, context: LaunchContext) -> None:
        """Start the process. Raises RuntimeError if that was done before."""
        if self._executed:
            raise RuntimeError(f"{self.describe()} is executed twice: make an action for each process")
        self._executed = True
        if context.is_shutdown:
            return
        process = self.to_start(context)
        if self.on_exit is not None:
            context.register_event_handler(OnProcessExit(target_action=self, on_exit=self.on_exit))
        if self.log_cmd:
            command = " ".join(process.command)
            context.host.log("INFO", process.name, f"process details: cmd='{command}', cwd='{process.cwd}'")
        context.host.start(self, process)

    def to_start(self, context: LaunchContext) -> ProcessToStart:
        """Return the process with all substitutions performed. Raises RuntimeError."""
        label, words = self.label_and_command(context)
        prefix = self._prefix(context, label)
        name = label if self.name is None else performed(context, self.name)
        stdout, stderr = places_of(context, self.output)
        return ProcessToStart(
            name=f"{name}-{next(_numbers)}",
            command=[*prefix, *words],
            cwd=None if self.cwd is None else performed(context, self.cwd),
            env=self._environment(context),
            stdout=stdout,
            stderr=stderr,
            sigterm_timeout=_seconds(context, "sigterm_timeout", self.sigterm_timeout),
            sigkill_timeout=_seconds(context, "sigkill_timeout", self.sigkill_timeout),
            shell=_truth(context, self.shell),
            emulate_tty=_truth(context, context.launch_configurations.get("emulate_tty", self.emulate_tty)),
            respawn=_truth(context, self.respawn),
            respawn_delay=self.respawn_delay or 0.0,
            respawn_max_retries=self.respawn_max_retries,
        )

    def label_and_command(self, context: LaunchContext) -> tuple[str, list[str]]:
        """Return the name of the program, and the words that start it."""
        words = [perform_substitutions(context, word) for word in self.cmd]
        if not words or not words[0]:
            raise RuntimeError("the command of a process is empty")
        first = shlex.split(words[0])[0] if _truth(context, self.shell) else words[0]
        return Path(first).name, words

    def _prefix(self, context: LaunchContext, label: str) -> list[str]:
        configurations = context.launch_configurations
        if self.prefix is not None:
            return shlex.split(performed(context, self.prefix))
        pattern = str(configurations.get("launch-prefix-filter", ""))
        if pattern and re.match(pattern, label) is None:
            return []
        return shlex.split(str(configurations.get("launch-prefix", "")))

    def _environment(self, context: LaunchContext) -> dict[str, str]:
        found = dict(context.environment) if self.env is None else {}
        for name, value in (*(self.env or {}).items(), *(self.additional_env or {}).items()):
            found[performed(context, name)] = performed(context, value)
        return found


def _truth(context: LaunchContext, value: bool | SomeSubstitutionsType) -> bool:
    return value if isinstance(value, bool) else evaluate_condition_expression(context, value)


def _seconds(context: LaunchContext, what: str, value: SomeSubstitutionsType | float) -> float:
    text = str(value) if isinstance(value, int | float) else performed(context, value)
    try:
        return float(text)
    except ValueError:
        raise RuntimeError(f"{what} must be a number of seconds, got '{text}'") from None
