"""Executables: the command of a process, and what belongs to it before it starts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

__all__ = ["Executable"]

Variables = Mapping[SomeSubstitutionsType, SomeSubstitutionsType]


class Executable:
    """A command, each word a text or a list of substitutions; `arguments` come after it.

    `env` is the whole environment, `additional_env` adds to that of the launch. `prefix` comes before the
    command.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Variables | None = None,
        additional_env: Variables | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
    ) -> None:
        self.arguments = [normalize_to_list_of_substitutions(word) for word in arguments or ()]
        self.cmd = [*(normalize_to_list_of_substitutions(word) for word in cmd), *self.arguments]
        self.prefix = prefix
        self.name = name
        self.cwd = cwd
        self.env = env
        self.additional_env = additional_env
        self.final_name: str | None = None
        """The name of the process, with its number, once it is executed."""

    @property
    def final_cmd(self) -> list[str] | None:
        """The command with its substitutions performed, after `prepare`."""
        return self._final

    _final: list[str] | None = None

    def prepare(self, context: LaunchContext, action: object = None) -> None:
        """Perform the substitutions of the command."""
        self._final = [perform_substitutions(context, word) for word in self.cmd]
