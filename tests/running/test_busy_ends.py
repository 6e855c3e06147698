"""Programs that end while they are busy: with the code that they want, and with nothing on stderr but their own."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from tests.running.terminals import LIMIT, Machine, Terminal

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)

BUSY = str(Path(__file__).parent / "peers/busy.py")
FAST = str(Path(__file__).parent / "peers/fast.py")
CODES = {"exit": 0, "raise": 1}
LAST = {"exit": "ready", "raise": "RuntimeError: on purpose"}


def test_who_leaves_busy_daemon_threads_behind_ends_clean(machine: Machine) -> None:
    server = machine.run("serve", "stay", program=BUSY)
    server.until("ready")
    for role, how in (("ask", "exit"), ("publish", "raise")):
        busy = machine.run(role, how, program=BUSY)
        assert busy.process.wait(LIMIT) == CODES[how], busy.rest()
        assert _last(busy) == LAST[how]
    assert server.end() == 0
    assert server.lines == ["ready"]


def test_a_server_that_leaves_within_its_callback_ends_clean(machine: Machine) -> None:
    server = machine.run("serve", "exit", program=BUSY)
    server.until("ready")
    machine.run("ask", "stay", program=BUSY)
    assert server.process.wait(LIMIT) == 0
    assert server.rest() == ["ready"]


@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM], ids=["interrupted", "terminated"])
def test_who_publishes_or_receives_at_full_speed_ends_clean(machine: Machine, end: signal.Signals) -> None:
    listener, talker = machine.run("listen", program=FAST), machine.run("talk", program=FAST)
    listener.until("heard 1")
    for each in (talker, listener):
        each.process.send_signal(end)
        assert each.process.wait(LIMIT) == 0
        assert not [line for line in each.rest() if not line.startswith("heard")]
    assert list(machine.folder.iterdir()) == []


@pytest.mark.slow
def test_who_vanishes_at_full_speed_disturbs_nobody(machine: Machine) -> None:
    listener = machine.run("listen", program=FAST)
    listener.until("heard")
    for _ in range(2):
        vanishing = machine.run("vanish", program=FAST)
        assert vanishing.process.wait(LIMIT) == 3
        assert vanishing.rest() == []
    assert listener.end() == 0
    assert not [line for line in listener.lines if not line.startswith("heard")]


def _last(terminal: Terminal) -> str:
    """The last line; "ready" is the only one of a program that has nothing to say."""
    lines = terminal.rest()
    return lines[-1] if lines else "ready"
