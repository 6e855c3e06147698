"""A deterministic run that spans processes: they advance virtual time together.

    from rmw_local import lockstep

    result = lockstep.run(simulate, control)  # functions, each in a process of its own

A run consists of rounds. In a round, each process runs until nobody in it has anything more to do. What nodes
send, to whichever process, arrives at the end of the round: ordered by the full names of the nodes that sent
it, and for each of them in its own order. If nothing arrives anywhere, time passes to the earliest timer or
timeout of all. So a run depends neither on the speed of the machine, nor on which nodes share a process.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

__all__ = ["LockstepError", "run"]

PATIENCE = 60.0
"""Seconds of real time that a process may take for what it does at one moment of virtual time."""


class LockstepError(RuntimeError):
    """A run in lockstep cannot go on; the text says which program is to blame, when, and why."""

    def __init__(self, text: str, exit_code: int = 1) -> None:
        super().__init__(text)
        self.exit_code = exit_code
        """The exit code of that program, or 1."""


class RunHasEnded(BaseException):
    """Raised in the programs of a run that has failed elsewhere, with the reason. No program handles it."""


def run(
    *programs: Callable[[], Any], seed: int = 0, patience: float = PATIENCE, names: Sequence[str] = ()
) -> Any:
    """Call each program in a process of its own, in lockstep, and return what the last one returns.

    A program is a function that can be pickled, such as one of a module, or a `functools.partial` of one. The
    others are then interrupted, as by Ctrl-C. `seed` decides about the order of threads. `names` of the
    programs are for messages. Raises LockstepError if one of them fails, ends with an error, or takes longer
    than `patience`.
    """
    from rmw_local.lockstep.coordinator import Coordinator  # late: most programs are none

    if not programs:
        raise ValueError("there is no program to run")
    return Coordinator(programs, names or [_name(each) for each in programs], seed, patience).run()


def _name(program: Callable[[], Any]) -> str:
    inner = program.func if isinstance(program, partial) else program
    return getattr(inner, "__name__", type(inner).__name__)
