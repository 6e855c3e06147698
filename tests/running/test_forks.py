"""Processes that fork in the middle of traffic: parents and children are strangers to each other."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.running.terminals import LIMIT, Machine

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)

FORKING = str(Path(__file__).parent / "peers/forking.py")


@pytest.mark.slow
@pytest.mark.parametrize("how", ["forkserver", "spawn"])
def test_children_that_are_started_afresh_meet_everybody(machine: Machine, how: str) -> None:
    listener = machine.run("l", "listen")
    listener.until("nodes l")
    parent = machine.run(how, program=FORKING)
    assert parent.process.wait(LIMIT) == 0, parent.rest()
    assert parent.rest() == [
        *(line for n in (1, 2, 3) for line in (f"child {n} sees child{n} l parent", "code 0")),
        "nodes l parent",
    ]
    for number in (1, 2, 3):
        listener.until(f"heard {1000 * number}")
    listener.until("nodes l zenoh")
    assert listener.end() == 0


def test_a_fork_before_anybody_has_come_meets_its_parent(machine: Machine) -> None:
    parent = machine.run("early", program=FORKING)
    assert parent.process.wait(LIMIT) == 0
    assert parent.rest() == ["child 1 sees child1 parent", "code 0", "nodes parent"]


@pytest.mark.slow
@pytest.mark.parametrize("attempt", range(4))
def test_forks_while_the_parent_opens_its_session_come_to_their_end(machine: Machine, attempt: int) -> None:
    parent = machine.run("volley", program=FORKING)
    assert parent.process.wait(LIMIT) == 0, parent.rest()
    assert parent.rest()[-1] == "codes 0 0 0 0 0 0"


@pytest.mark.parametrize("how", ["os", pytest.param("fork", marks=pytest.mark.slow)])
def test_a_later_fork_is_told_that_it_is_alone_and_disturbs_nobody(machine: Machine, how: str) -> None:
    listener = machine.run("l", "listen")
    listener.until("nodes l")
    parent = machine.run(how, program=FORKING)
    listener.until("heard")
    assert parent.process.wait(LIMIT) == 0, parent.rest()
    warnings = [
        line for line in parent.rest() if line.startswith("rmw_local: other processes are not reached")
    ]
    assert len(warnings) == 3
    assert "'spawn' or 'forkserver'" in warnings[0]
    assert [line for line in parent.lines if line not in warnings] == [
        *(line for n in (1, 2, 3) for line in (f"child {n} sees child{n}", "code 0")),
        "nodes l parent",
    ]
    listener.until("nodes l zenoh")
    assert not any(line.startswith("heard") and int(line.split()[1]) % 1000 == 0 for line in listener.lines)
    assert listener.end() == 0
