"""A session beside programs that end with it, for commands such as `ifgen graph --run talker.py`."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from signal import SIGINT
from typing import Final

from ifgen.command_kit.tool import ToolError
from ifgen.diagnostics import Diagnostic, UsageError
from ifgen.signals import sigterm_raises

from ifgen_tools import ros_graph
from ifgen_tools.running import processes
from ifgen_tools.running.ending import PATIENCE
from ifgen_tools.session import Session, Transport, activate, open_session
from ifgen_tools.verbs import TransportChoice

_QUIET: Final = 1.0
"""Seconds without a change after which programs have started, and their endpoints are known."""

_START: Final = 15.0
"""Seconds after which a graph that still changes is taken as it is."""

_DISCOVERY: Final = 5.0
"""The same for a graph to which this command adds no program."""

_OWN_INTERRUPTION: Final = 0.5
"""Seconds in which programs end that got the terminal's Ctrl-C, too."""


@contextmanager
def session_beside(programs: Sequence[Sequence[str]], transport: TransportChoice) -> Generator[Session]:
    """A session that knows the graph, with programs in processes of their own until the block ends.

    Each program is words as for `ifgen run`; what it prints goes to stderr. Raises UsageError if there is no
    such transport, or if all programs have ended before anybody could look at their nodes.
    """
    try:
        chosen = activate(transport)
    except ToolError as error:
        raise UsageError([Diagnostic("no-transport", error.message)]) from None
    with sigterm_raises(), _running(programs, chosen) as started, open_session(chosen) as session:
        if started:
            session.lookout.say = lambda _: None  # they take a while to come
        _discover(session, started)
        codes = [code for process in started if (code := process.poll()) is not None]
        if started and len(codes) == len(started) and not ros_graph.node_names(session.node):
            code = max(map(_as_shells_count, codes))
            message = f"the graph could not be observed: the programs ended with exit code {code}"
            advice = "run them with `ifgen run` to see why"
            raise UsageError([Diagnostic("no-graph", message, help=advice)])
        yield session


def _discover(session: Session, started: Sequence[subprocess.Popen[bytes]]) -> None:
    """Wait until each program that runs has a node, and nothing changes any more."""

    def everybody_is_here() -> bool:
        expected = sum(process.poll() is None for process in started) if started else 1
        return len(ros_graph.node_names(session.node)) >= expected

    if not started and session.transport == "local":
        session.discover()
    else:
        session.settle(
            session.graph,
            everybody_is_here,
            quiet=_QUIET,
            patience=_START if started else _DISCOVERY,
        )
        session.lookout.look_around()


@contextmanager
def _running(
    programs: Sequence[Sequence[str]], transport: Transport
) -> Generator[list[subprocess.Popen[bytes]]]:
    """Run programs, each in a process, and interrupt them at the end of the block as by Ctrl-C."""
    if not programs:
        yield []
        return
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport]
    with (
        tempfile.TemporaryDirectory(prefix="ifgen-run-") as folder,
        processes.meeting_place(transport) as place,
    ):
        os.environ.update(place)  # for this process, too
        note = Path(folder) / "dismissed"
        environment = {**os.environ, processes.NOTE: str(note)}
        started: list[subprocess.Popen[bytes]] = []
        grace = _OWN_INTERRUPTION
        try:
            with processes.signals_wait():
                started += (
                    subprocess.Popen([*command, *words], env=environment, stdout=2) for words in programs
                )
            yield started
            grace = 0.0
        finally:
            note.touch()
            _end(started, grace)


def _end(started: Sequence[subprocess.Popen[bytes]], grace: float) -> None:
    """Interrupt the programs that have not ended after some seconds of grace, and wait for them."""
    _wait(started, grace)
    for process in started:
        if process.poll() is None:
            process.send_signal(SIGINT)
    _wait(started, PATIENCE)
    for process in started:
        if process.poll() is None:
            process.kill()
            process.wait()


def _wait(started: Sequence[subprocess.Popen[bytes]], timeout: float) -> None:
    end = time.monotonic() + timeout
    for process in started:
        try:
            process.wait(max(0.0, end - time.monotonic()))
        except subprocess.TimeoutExpired:
            continue


def _as_shells_count(code: int) -> int:
    return 128 - code if code < 0 else code
