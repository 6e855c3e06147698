"""Two programs with two versions of a type: what differs is said, whatever becomes of the other one."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.running.terminals import Machine, Terminal

PROGRAM = str(Path(__file__).parent / "peers/versions.py")


@pytest.fixture
def go(tmp_path: Path) -> Path:
    """The file that lets the newer one make its subscription."""
    return tmp_path / "go"


@pytest.fixture
def two(machine: Machine, go: Path) -> tuple[Terminal, Terminal]:
    """The older one with its publisher, and the newer one, which knows it."""
    old = machine.run("old", str(Path(__file__)), program=PROGRAM)
    old.until("made")
    new = machine.run("new", str(go), program=PROGRAM)
    new.until("nodes new old")
    old.until("nodes new old")
    return old, new


def test_both_say_which_field_differs(two: tuple[Terminal, Terminal], go: Path) -> None:
    go.touch()
    for each in two:
        each.until("[WARN]")
        each.until("warning[field-")
        assert "depth" in each.lines[-1]
        assert each.end() == 0, "\n".join(each.lines)
        assert sum("[WARN]" in line for line in each.lines) == 1
        assert each.lines[-1] == "ended"


def test_a_stopped_one_is_told_of_without_its_definition(two: tuple[Terminal, Terminal], go: Path) -> None:
    old, new = two
    old.process.send_signal(signal.SIGSTOP)
    go.touch()
    new.until("made")
    new.until("[WARN]")
    new.until("what differs is unknown: /old did not")
    old.process.send_signal(signal.SIGCONT)
    old.until("warning[field-")
    for each in (old, new):
        assert each.end() == 0, "\n".join(each.lines)


@pytest.mark.parametrize("stopped", [True, False])
def test_who_ends_meanwhile_says_nothing_more(
    two: tuple[Terminal, Terminal], go: Path, stopped: bool
) -> None:
    old, new = two
    if stopped:
        old.process.send_signal(signal.SIGSTOP)
    go.touch()
    new.until("made")
    assert new.end() == 0, "\n".join(new.lines)
    assert new.lines[-1] == "ended"


def test_one_that_is_killed_while_it_is_asked(two: tuple[Terminal, Terminal], go: Path) -> None:
    old, new = two
    old.process.send_signal(signal.SIGSTOP)
    go.touch()
    new.until("made")
    old.process.kill()
    new.until("[WARN]")
    assert new.end() == 0, "\n".join(new.lines)
