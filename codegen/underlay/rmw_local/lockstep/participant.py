"""One process of a lockstep run: calls a function, and tells the coordinator how it ends."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from rmw_local.lockstep.channel import Channel
from rmw_local.lockstep.driver import lockstep_time
from rmw_local.lockstep.errors import RunHasEnded
from rmw_local.lockstep.side import Side

if TYPE_CHECKING:
    import socket

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
