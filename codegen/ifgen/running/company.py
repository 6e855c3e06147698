"""Runs several programs in one process, each on a thread that it takes for the main thread of its process.

`ifgen run server.py : client.py 41 1`: they talk through the local transport, which needs them here. What a
process has once, each program gets as its own, as far as Python allows: see `own/`. docs/cli.md
says what stays common to all.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from functools import partial
from importlib import import_module
from typing import Any

from ifgen.running.companion import Companion, current
from ifgen.running.ending import INTERRUPTED, PATIENCE, exit_code, is_interruption, tell
from ifgen.running.own.attributes import OwnAttributes, OwnStreams, WholeLines
from ifgen.running.own.exits import OwnExits
from ifgen.running.own.logging import OwnLogging
from ifgen.running.own.modules import OwnModules
from ifgen.running.own.signals import OwnSignals
from ifgen.running.own.threads import OwnThreads
from ifgen.running.program import Program

_CLONE_FS = 0x200  # sched.h
_STEP = 0.2  # [s] on some systems a waiting thread does not notice a signal


def run(programs: Sequence[Program], *, until_all_end: bool = False) -> int:
    """Run programs until the last one ends, or all of them; returns the worst of their exit codes."""
    company = _Company(programs, until_all_end=until_all_end)
    return company.run()


class _Company:
    def __init__(self, programs: Sequence[Program], *, until_all_end: bool) -> None:
        # Found by name: the toolkit does not depend on an rclpy.
        self._ros = import_module("rclpy.impl.program")
        self._all = [Companion(program, self._ros.Program()) for program in programs]
        self._signals = OwnSignals(self._all, self._on_ending_signal)
        self._modules = OwnModules()
        self._threads = OwnThreads(self._signals.notice)
        self._exits = OwnExits()
        self._path = list(sys.path)
        self._streams = {name: getattr(sys, name) for name in ("stdin", "stdout", "stderr")}
        self._signals_seen = 0
        self._process = os.getpid()
        self._until_all_end = until_all_end

    def run(self) -> int:
        """Run them all."""
        with ExitStack() as stack:
            for each in (
                OwnAttributes(sys, "argv", "path", "excepthook", *self._streams),
                OwnStreams(sys, *(name for name, stream in self._streams.items() if stream is not None)),
                self._modules,
                self._threads,
                OwnLogging(),
                self._exits,
                self._signals,
                self._ros.shared(_ros_program, self._signals.notice),
            ):
                stack.enter_context(each)
            for companion in self._all:
                self._modules.add(companion)
                for name, stream in self._streams.items():
                    shared = self._until_all_end and stream is not None and name != "stdin"
                    companion.attributes[sys, name] = WholeLines(stream) if shared else stream
                companion.attributes[sys, "path"] = list(self._path)
                self._threads.start_main(companion, partial(self._live, companion))
            self._wait()
            return max(map(self._code, self._all))

    def _wait(self) -> None:
        """Wait for the last program, or for all; then dismiss the others, and wait for those for a while."""
        awaited = self._all if self._until_all_end else self._all[-1:]
        while not all(each.ended.is_set() for each in awaited) and not self._signals_seen:
            self._signals.serve(_STEP)
        if not self._signals_seen:
            for companion in self._all:
                companion.dismissed = not companion.ended.is_set()
                self._signals.deliver(companion, signal.SIGINT)
        end = time.monotonic() + PATIENCE
        while (left := end - time.monotonic()) > 0 and self._signals_seen < 2 and self._running():
            self._signals.serve(min(left, _STEP))
        for companion in self._running():
            when = (
                f"within {PATIENCE:.0f} s after Ctrl-C" if self._signals_seen < 2 else "at the second Ctrl-C"
            )
            print(f"ifgen: {companion.program.name} did not end {when}; leaving it", file=sys.stderr)

    def _running(self) -> list[Companion]:
        return [companion for companion in self._all if not companion.ended.is_set()]

    def _on_ending_signal(self, number: int) -> None:
        self._signals_seen += 1
        self._signals.wake()

    def _live(self, companion: Companion) -> None:
        """Do what a process does from the first line of its program to its end."""
        _have_own_folder()
        companion.main.run(companion.program.execute)
        ending = companion.main.ending
        if ending is not None and not (companion.dismissed and is_interruption(ending)):
            tell(ending)
        self._threads.wait_for_others(companion, companion.hurry)
        self._exits.run(companion)
        for name in ("stdout", "stderr"):
            with suppress(Exception):  # closed, or None
                getattr(sys, name).flush()
        if os.getpid() != self._process:  # a fork of it has come to its end
            self._exits.exit(exit_code(ending))
        companion.leave()
        self._signals.wake()

    def _code(self, companion: Companion) -> int:
        if not companion.ended.is_set():
            return 1
        if companion.dismissed and is_interruption(companion.main.ending):
            return 0
        code = exit_code(companion.main.ending) if companion.code is None else companion.code
        return 0 if companion.dismissed and code == INTERRUPTED else code


def _have_own_folder() -> None:
    """Let this thread and those that it starts have a working folder of their own, where the system can."""
    if sys.platform == "linux":
        with suppress(AttributeError):  # a C library without it
            ctypes.CDLL(None).unshare(_CLONE_FS)


def _ros_program() -> Any:
    companion = current()
    return None if companion is None else companion.ros
