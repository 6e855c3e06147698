"""Processes."""

from __future__ import annotations

import asyncio
import os
import re
import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any, cast

from launch.action import Action
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.descriptions import Executable
from launch.event_handler import as_list
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
from launch.launch_context import LaunchContext, ProcessToStart
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.logging import get_logger, normalize_output_configuration
from launch.some_entities_type import SomeEntitiesType
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import LaunchConfiguration
from launch.utilities import perform_substitutions, performed

_numbers = count(1)


class ExecuteLocal(Action):
    """A process that a description of an executable says how to start, and what belongs to it.

    `output` says where its lines go (screen, log, both, own_log, full, or a dict by stream). `respawn` starts
    it again when it ends. At a shutdown it gets SIGINT, after `sigterm_timeout` [s] SIGTERM, and after
    `sigkill_timeout` [s] more SIGKILL.
    """

    def __init__(
        self,
        *,
        process_description: Executable,
        shell: bool | SomeSubstitutionsType = False,
        sigterm_timeout: SomeSubstitutionsType | None = None,
        sigkill_timeout: SomeSubstitutionsType | None = None,
        emulate_tty: bool | SomeSubstitutionsType = False,
        output: SomeSubstitutionsType | Mapping[str, Any] = "log",
        output_format: str = "[{this.process_description.final_name}] {line}",
        cached_output: bool = False,
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
        self.process_description = process_description
        self.shell = shell
        self.sigterm_timeout = sigterm_timeout or LaunchConfiguration("sigterm_timeout", default=5)
        self.sigkill_timeout = sigkill_timeout or LaunchConfiguration("sigkill_timeout", default=5)
        self.emulate_tty = emulate_tty
        self.output = output
        self.cached_output = cached_output
        self.log_cmd = log_cmd
        self.on_exit = on_exit
        self.respawn = respawn
        self.respawn_delay = respawn_delay
        self.respawn_max_retries = respawn_max_retries
        self.process_details: dict[str, Any] | None = None
        self.return_code: int | None = None
        self._completed: asyncio.Future[None] | None = None
        self._executed = False

    @property
    def cmd(self) -> list[list[Substitution]]:
        """The words of the command."""
        return self.process_description.cmd

    @property
    def name(self) -> SomeSubstitutionsType | None:
        """The name of the process, which lines and events have."""
        return self.process_description.name

    @property
    def cwd(self) -> SomeSubstitutionsType | None:
        """The working directory; None: that of the launch."""
        return self.process_description.cwd

    @property
    def env(self) -> Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None:
        """The whole environment; None: that of the launch."""
        return self.process_description.env

    @property
    def additional_env(self) -> Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None:
        """Variables that come on top of the environment."""
        return self.process_description.additional_env

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return the future that is done when the process has ended; None before it is executed."""
        return self._completed

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

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity] | None:
        """Start the process. Raises RuntimeError if that was done before."""
        if self._executed:
            raise RuntimeError(f"{self.describe()} is executed twice: make an action for each process")
        self._executed = True
        if context.asyncio_loop is not None:
            self._completed = context.asyncio_loop.create_future()
        if context.is_shutdown:
            self.note_completion()
            return None
        process = self.to_start(context)
        if self.on_exit is not None:
            context.register_event_handler(OnProcessExit(target_action=self, on_exit=self.on_exit))
        if self.log_cmd:
            command = " ".join(process.command)
            get_logger(process.name).info(f"process details: cmd='{command}', cwd='{process.cwd}'")
        context.host.start([self], process)
        return None

    def note_completion(self) -> None:
        """Complete the future, once."""
        if self._completed is not None and not self._completed.done():
            self._completed.set_result(None)

    def to_start(self, context: LaunchContext) -> ProcessToStart:
        """Return the process with all substitutions performed. Raises RuntimeError."""
        label, words = self.label_and_command(context)
        prefix = self._prefix(context, label)
        name = label if self.name is None else performed(context, self.name)
        command = [*prefix, *words]
        self.process_description.final_name = f"{name}-{next(_numbers)}"
        places = self._places(context)
        return ProcessToStart(
            name=self.process_description.final_name,
            command=command,
            cwd=None if self.cwd is None else performed(context, self.cwd),
            env=self._environment(context),
            stdout=places["stdout"],
            stderr=places["stderr"],
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

    def _places(self, context: LaunchContext) -> dict[str, frozenset[str]]:
        output: Any = os.environ.get("OVERRIDE_LAUNCH_PROCESS_OUTPUT", self.output)
        if not isinstance(output, dict):
            return normalize_output_configuration(performed(context, output))
        return normalize_output_configuration(cast("dict[str, Any]", output))

    def _prefix(self, context: LaunchContext, label: str) -> list[str]:
        configurations = context.launch_configurations
        if self.process_description.prefix is not None:
            return shlex.split(performed(context, self.process_description.prefix))
        pattern = str(configurations.get("launch-prefix-filter", ""))
        if pattern and re.match(pattern, label) is None:
            return []
        return shlex.split(str(configurations.get("launch-prefix", "")))

    def _environment(self, context: LaunchContext) -> dict[str, str]:
        found = dict(context.environment) if self.env is None else {}
        for name, value in (*(self.env or {}).items(), *(self.additional_env or {}).items()):
            found[performed(context, name)] = performed(context, value)
        return found


class ExecuteProcess(ExecuteLocal):
    """A process: its command, each word a text or a list of substitutions, and what belongs to it."""

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        additional_env: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        **kwargs: Any,
    ) -> None:
        executable = Executable(
            cmd=cmd, prefix=prefix, name=name, cwd=cwd, env=env, additional_env=additional_env
        )
        super().__init__(process_description=executable, **kwargs)


def _truth(context: LaunchContext, value: bool | SomeSubstitutionsType) -> bool:
    return value if isinstance(value, bool) else evaluate_condition_expression(context, value)


def _seconds(context: LaunchContext, what: str, value: SomeSubstitutionsType | float) -> float:
    text = str(value) if isinstance(value, int | float) else performed(context, value)
    try:
        return float(text)
    except ValueError:
        raise RuntimeError(f"{what} must be a number of seconds, got '{text}'") from None
