"""One process of a lockstep run: its time, the function that it calls, and what it tells the coordinator."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Final

from rmw_local.lockstep import RunHasEnded
from rmw_local.lockstep.side import Channel, Side
from rmw_local.virtual_time import VirtualDriver, driven_by

if TYPE_CHECKING:
    import socket

    from rmw_local.lockstep.side import Side
    from rmw_local.virtual_time import Member


_PATIENCE: Final = 100_000  # readings: how often a process looks must not depend on who else is in it


class LockstepDriver(VirtualDriver):
    """The driver of one process; the thread that makes it, the main thread, has the first turn."""

    patience = _PATIENCE

    def __init__(self, side: Side, seed: int = 0) -> None:
        super().__init__(seed)
        self.side = self._side = side
        self._interrupts = False  # the main thread, when it is its turn
        assert self._running is not None
        self._main = self._running

    def _let_time_pass(self, deadline: int | None) -> bool:
        side = self._side
        was_over, keeps = side.is_over, side.keeps_something
        self._now = max(self._now, side.exchange(deadline, self._now))
        if side.failure:
            return False
        if not side.is_over or (was_over and keeps):
            return True
        if not was_over:
            self._interrupts = True
            return True
        return super()._let_time_pass(deadline)

    def _can_run(self, member: Member) -> bool:
        return (self._interrupts and member is self._main) or super()._can_run(member)

    def _stuck(self) -> Member | None:
        if not self._side.failure or not self._members:
            return super()._stuck()
        first = min(self._members.values(), key=lambda member: member.number)
        first.error = RunHasEnded(self._side.failure)
        return first

    def _await_turn(self, me: Member) -> None:
        super()._await_turn(me)
        if self._interrupts and threading.current_thread() is threading.main_thread():
            self._interrupts = False
            signal.raise_signal(signal.SIGINT)


@contextmanager
def lockstep_time(side: Side, seed: int) -> Generator[LockstepDriver]:
    """Run the block as one process of a lockstep run."""
    with driven_by(LockstepDriver(side, seed)) as driver:
        yield driver


_INTERRUPTED: Final = 130  # as shells say it


def take_part(end: socket.socket, number: int, name: str, seed: int, program: Callable[[], Any]) -> None:
    """Be process `number` of a run: call the program, and send what it returns. Ends the process."""
    if hasattr(os, "setpgrp"):
        os.setpgrp()  # Ctrl-C is for the coordinator, which ends all in turn
    channel = Channel(end)
    channel.send("here")
    side = Side(number, channel)
    result, code, why = None, 0, ""
    with lockstep_time(side, seed):
        try:
            result = program()
            _wait_for_threads()
        except RunHasEnded as error:
            _say(f"{name}: the run has ended: {error}")
            code = 1
        except SystemExit as ending:
            code, why = _code_of(ending)
        except BaseException as error:
            if not _is_interruption(error):
                trace = error.__traceback__
                sys.excepthook(type(error), error, trace and trace.tb_next)  # as Python itself does
                code, why = 1, _raised(error)
            elif not side.is_over:
                code, why = _INTERRUPTED, "it was interrupted"
        _say_farewell(side, result, code, why)
    if any(_outlives(thread) for thread in threading.enumerate()):
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(code)  # Python would wait for them, and they for a run that is over
    sys.exit(code)


def _say_farewell(side: Side, result: Any, code: int, why: str) -> None:
    with suppress(OSError):
        try:
            side.farewell((result, code, why))
        except (TypeError, AttributeError, ValueError) as error:  # of pickle, before anything is sent
            side.farewell((None, 1, f"it returned what cannot be sent to another process: {error}"))


def _wait_for_threads() -> None:
    """Wait for threads that are not daemons, as Python does at its end."""
    for thread in threading.enumerate():
        if _outlives(thread):
            thread.join()


def _outlives(thread: threading.Thread) -> bool:
    return not thread.daemon and thread is not threading.main_thread()


def _code_of(ending: SystemExit) -> tuple[int, str]:
    if ending.code is None or isinstance(ending.code, int):
        code = (ending.code or 0) & 0xFF
        why = f"it left with exit code {code}" if ending.__cause__ is None else _raised(ending.__cause__)
        return code, why if code else ""
    _say(str(ending.code))
    return 1, f"it left with: {ending.code}"


def _raised(error: BaseException) -> str:
    return f"it raised {type(error).__name__}: {error}".rstrip(": ")


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _is_interruption(error: BaseException) -> bool:
    executors = sys.modules.get("rclpy.executors")
    kinds = (KeyboardInterrupt, *([executors.ExternalShutdownException] if executors else []))
    return isinstance(error, kinds)
