"""Runs that span processes: the same whichever nodes share one, and never a hang."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path

import pytest
from ifgen_pytest.domains import RANGE, own_domain
from rmw_local.graph import Participant
from rmw_local.lockstep import LockstepError, run
from rmw_local.lockstep.side import Channel
from rmw_local.virtual_time import virtual_time

from tests.rclpy.inside import lockstep_programs as programs

pytestmark = pytest.mark.slow  # each starts processes


def test_what_is_sent_at_one_moment_arrives_by_the_names_of_nodes() -> None:
    quick, slow, last = (partial(programs.talker, *each) for each in (("b", 0.1), ("c", 0.2), ("a", 0.1)))
    apart = run(
        *(partial(programs.spin, each) for each in (quick, slow, last)), partial(programs.listen, 0.25)
    )
    assert apart == [
        *((0.0, f"{name} begins") for name in "abc"),  # before the listener is there, but in the same round
        *((0.1, f"{name} {count}") for name in "ab" for count in (0, 1)),
        *((0.2, f"{name} {count}") for name in "abc" for count in ((0, 1) if name == "c" else (2, 3))),
    ]
    heard = partial(programs.heard_until, 0.25)
    assert run(partial(programs.together, slow, last, quick, last=heard)) == apart
    assert run(partial(programs.spin, slow), partial(programs.together, quick, last, last=heard)) == apart


def test_services_actions_parameters_and_late_joiners() -> None:
    apart = run(partial(programs.spin, programs.provider), programs.use)
    assert apart == [
        *((1.5, (number, *text)) for text in (("old", 3), ("older", 500_000)) for number in (1, 2)),
        (2.0, 42),
        (2.0, 0.1),
        (2.0, [0]),
        (2.25, [1]),
        (2.5, [0, 1, 1]),
        (2.5, ["provider", "user"]),
    ]
    assert run(partial(programs.together, programs.provider, last=programs.used)) == apart


def test_the_others_are_interrupted_when_the_last_one_ends(tmp_path: Path) -> None:
    note = tmp_path / "note"
    assert run(partial(programs.say_goodbye, str(note)), programs.sleep) == "slept"
    assert note.read_text() == "interrupted at 360.0 s"


@pytest.mark.parametrize(
    ("program", "why"),
    [
        (programs.fail, "fail ended the run at 0.100 s: it raised ValueError: no such joint"),
        (programs.leave, "leave ended the run at 0.000 s: it left with exit code 3"),
        (programs.be_killed, "be_killed was killed by signal 9 at 12.000 s"),
        (
            programs.hang,
            "hang has been busy at 0.000 s for 2 s of real time: it computes without end, .*",
        ),
    ],
)
def test_a_program_that_fails_ends_the_run(
    program: object, why: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(LockstepError, match=f"^{why}$") as failure:
        run(program, programs.sleep, patience=2.0)
    told = capfd.readouterr().err
    assert f"sleep: the run has ended: {failure.value}\n" in told
    assert told.count("Traceback") == (program is programs.fail)


def test_a_program_that_no_other_process_can_call() -> None:
    with pytest.raises(LockstepError, match=r"^<lambda> cannot be called in another process: "):
        run(programs.sleep, lambda: None)


def test_programs_that_wait_for_each_other_for_ever() -> None:
    with pytest.raises(
        LockstepError, match=r"nothing will ever happen again after 0.000 s: .*: wait_for_ever$"
    ):
        run(programs.wait_for_ever)


@pytest.mark.parametrize(
    ("is_virtual", "others_are"), [(True, True), (True, False), (False, True), (False, False)]
)
def test_a_virtual_clock_alone_crosses_no_processes_and_says_so(
    is_virtual: bool, others_are: bool, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(RANGE, "LOCALHOST")
    with own_domain() as domain, beside(domain, others_are):
        with virtual_time() if is_virtual else nullcontext():
            participant = Participant(domain)
            participant.create_node("n", "/").close()
        assert is_virtual <= (participant.domain.link is None)
    said = [line for line in capfd.readouterr().err.splitlines() if "virtual clock" in line]
    who, whom = ("this program", f"others in ROS domain {domain} are")
    if not is_virtual:
        who, whom = f"another program in ROS domain {domain}", "it is"
    advice = (
        "start them together in lockstep, with `ifgen run --lockstep`, or set "
        "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF for one that is to be alone"
    )
    line = f"rmw_local: {who} runs on a virtual clock, so {whom} not reached: {advice}"
    assert said == ([line] if is_virtual or others_are else [])


@contextmanager
def beside(domain: int, is_virtual: bool) -> Generator[None]:
    """Another process with a node in a domain."""
    program = """if True:
        import sys
        from contextlib import nullcontext
        from rmw_local.graph import Participant
        from rmw_local.virtual_time import virtual_time
        with virtual_time() if sys.argv[2] else nullcontext():
            Participant(int(sys.argv[1])).create_node("other", "/")
            print(flush=True)
            sys.stdin.read()
    """
    command = [sys.executable, "-c", program, str(domain), "yes" if is_virtual else ""]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ}
    ) as other:
        assert other.stdin is not None and other.stdout is not None
        assert other.stdout.readline()
        yield
        other.stdin.close()


def test_a_channel_keeps_apart_what_comes_together() -> None:
    here, there = map(Channel, socket.socketpair())
    sent = ["here", ("idle", b"x" * 70_000), ("end", ""), b""]
    for each in sent:
        here.send(each)
    assert [there.receive() for _ in sent] == sent
    here.close()
    with pytest.raises(EOFError, match="the other end is gone"):
        there.receive()
    there.close()
