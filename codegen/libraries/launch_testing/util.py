"""Processes by their names, and an action that keeps a launch alive."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final, Protocol

from launch.actions import ExecuteLocal, TimerAction

__all__ = ["NO_CMD_ARGS", "KeepAliveProc", "NoMatchingProcessException", "resolveProcesses"]

NO_CMD_ARGS: Final[Any] = object()
"""Stands for a process without arguments."""


class NoMatchingProcessException(Exception):
    """No process has this name and these arguments."""


class HasProcesses(Protocol):
    """Knows processes: an IoHandler or a ProcInfoHandler."""

    def processes(self) -> Iterable[ExecuteLocal]:
        """Return their actions."""
        ...


class KeepAliveProc(TimerAction):
    """Keeps a launch alive that starts no process."""

    def __init__(self) -> None:
        super().__init__(period=1e6, actions=[])


def resolveProcesses(
    info_obj: HasProcesses,
    *,
    process: ExecuteLocal | str | None = None,
    cmd_args: str | Sequence[str] | None = None,
    strict_proc_matching: bool = True,
) -> list[ExecuteLocal]:
    """Return the processes with this action, or whose names contain a text; None stands for all.

    Raises NoMatchingProcessException, and with `strict_proc_matching` an Exception if a text means several.
    """
    known = list(info_obj.processes())
    if process is None:
        if not known:
            raise NoMatchingProcessException("No data recorded for any process")
        return known
    if isinstance(process, ExecuteLocal):
        if process not in known:
            raise NoMatchingProcessException(f"No data recorded for proc {_described(process)}")
        return [process]
    if not isinstance(process, str):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        raise TypeError(f"proc argument must be 'ExecuteProcess' or 'str' not {type(process)}")
    matches = [each for each in known if process in _details(each)["name"] and _fits(each, cmd_args)]
    names = ", ".join(sorted(map(_described, known)))
    if not matches:
        raise NoMatchingProcessException(
            f"Did not find any processes matching name '{process}' and args '{cmd_args}'. Procs: {names}"
        )
    if strict_proc_matching and len(matches) > 1:
        raise Exception(
            f"Found multiple processes matching name '{process}' and cmd_args '{cmd_args}'. Procs: {names}"
        )
    return matches


def _fits(process: ExecuteLocal, cmd_args: str | Sequence[str] | None) -> bool:
    given = _details(process)["cmd"][1:]
    if cmd_args is NO_CMD_ARGS:
        return not given
    wanted = [cmd_args] if isinstance(cmd_args, str) else cmd_args or ()
    return all(arg in given for arg in wanted)


def _described(process: ExecuteLocal) -> str:
    details = _details(process)
    return f"{details['name']} {' '.join(details['cmd'][1:])}" if details["name"] else process.describe()


def _details(process: ExecuteLocal) -> dict[str, Any]:
    return process.process_details or {"name": "", "cmd": []}
