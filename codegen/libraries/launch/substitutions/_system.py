"""Environment variables, outputs of commands, and names that nobody else has."""

from __future__ import annotations

import os
import random
import shlex
import socket
import subprocess

from launch.launch_context import LaunchContext
from launch.logging import get_logger
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions.substitution_failure import SubstitutionFailure
from launch.utilities import described, normalize_to_list_of_substitutions, perform_substitutions


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )

    def describe(self) -> str:
        """Return its name."""
        return f"EnvVar({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return its value, or the default. Raises SubstitutionFailure."""
        name = perform_substitutions(context, self.name)
        value = context.environment.get(name)
        if value is not None:
            return value
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform_substitutions(context, self.default_value)


class Command(Substitution):
    """The output of a command; `on_stderr`: fail, ignore, warn or capture if it writes errors."""

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail") -> None:
        self.command = normalize_to_list_of_substitutions(command)
        self.on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def describe(self) -> str:
        """Return the command."""
        return f"Command({described(self.command)})"

    def perform(self, context: LaunchContext) -> str:
        """Run the command, and return what it prints. Raises SubstitutionFailure."""
        command = perform_substitutions(context, self.command)
        mode = perform_substitutions(context, self.on_stderr)
        if mode not in {"fail", "ignore", "warn", "capture"}:
            raise SubstitutionFailure(f"on_stderr must be fail, ignore, warn or capture, got '{mode}'")
        if not context.runs_programs:
            raise SubstitutionFailure(f"the command '{command}' runs only when the launch does")
        try:
            words = shlex.split(command)
            done = subprocess.run(
                words, capture_output=True, text=True, check=False, env=dict(context.environment)
            )
        except (OSError, ValueError, IndexError) as error:
            raise SubstitutionFailure(f"cannot run the command '{command}': {error}") from None
        if done.returncode:
            raise SubstitutionFailure(
                f"the command '{command}' ended with {done.returncode}: {done.stderr.strip() or 'no output'}"
            )
        if done.stderr and mode == "fail":
            raise SubstitutionFailure(f"the command '{command}' wrote to stderr: {done.stderr.strip()}")
        if done.stderr and mode == "warn":
            get_logger().warning(f"the command '{command}' wrote to stderr: {done.stderr.strip()}")
        return done.stdout + (done.stderr if mode == "capture" else "")


class AnonName(Substitution):
    """A name that is the same throughout a launch, and that no other launch has."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self.name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Return the name."""
        return f"AnonName({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the name with the host, the process and a number."""
        name = perform_substitutions(context, self.name)
        key = "anon" + name
        if key not in context.launch_configurations:
            end = f"{socket.gethostname()}_{os.getpid()}_{random.getrandbits(32)}"
            whole = f"{name}_{end}"
            context.launch_configurations[key] = "".join(c if c.isalnum() else "_" for c in whole)
        return str(context.launch_configurations[key])
