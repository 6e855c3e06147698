"""Runs each of several programs in a process, with a virtual time that they share: `ifgen run --lockstep`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial

from ifgen_tools.running.ending import INTERRUPTED, is_interruption, tell
from ifgen_tools.running.program import Program


def run(programs: Sequence[Program]) -> int:
    """Run programs on the local transport until the last one ends; returns the exit code of what fails."""
    from rmw_local import lockstep  # late: it is found once the transport has been chosen

    calls = [partial(_execute, program) for program in programs]
    try:
        lockstep.run(*calls, names=[program.name for program in programs])
    except lockstep.LockstepError as error:
        print(f"ifgen: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0


def _execute(program: Program) -> None:
    """Run a program in the process that is there for it."""
    try:
        program.execute()
    except Exception as error:
        if is_interruption(error):
            raise
        tell(error)
        raise SystemExit(1) from error
