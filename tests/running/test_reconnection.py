"""Processes that lose each other and meet again: nothing kept is lost or comes twice, nobody stays in the graph."""

from __future__ import annotations

import signal
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.running.sites import Site
from tests.running.terminals import LIMIT, Command, Machine

pytest.importorskip("zenoh")

PROGRAM = str(Path(__file__).parent / "peers/keeping.py")


def heard(peer: Command, name: str) -> list[int]:
    """The numbers of a process that another one has heard, in order."""
    words = [line.split() for line in peer.so_far()]
    return [int(number) for kind, *rest in words if kind == "state" for who, number in [rest] if who == name]


def await_lines(peer: Command, since: int, *lines: str, limit: float = LIMIT) -> int:
    """Wait until a process has printed all of these after as many others; returns how many it has printed."""
    end = time.monotonic() + limit
    while not set(lines) <= set(peer.so_far()[since:]):
        assert time.monotonic() < end, f"{lines} are not in {peer.lines[since:]}, after {peer.lines[:since]}"
        time.sleep(0.02)
    return len(peer.lines)


def meet(one: Command, other: Command, number: int, since: Sequence[int] = (0, 0)) -> list[int]:
    """Wait until each sees the other, is answered by it, and has heard this number from it."""
    return [
        await_lines(peer, begin, "nodes a b publishers 2", f"state {name} {number}", f"echo {name}")
        for peer, name, begin in zip((one, other), "ba", since, strict=True)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("stopped", ["a", "b"])
def test_a_process_that_hangs_longer_than_its_lease_comes_back(machine: Machine, stopped: str) -> None:
    peers = {name: machine.run(name, program=PROGRAM) for name in "ab"}
    since = meet(peers["a"], peers["b"], 5)
    other, place = ("b", 1) if stopped == "a" else ("a", 0)
    peers[stopped].process.send_signal(signal.SIGSTOP)
    gone = await_lines(peers[other], since[place], f"nodes {other} publishers 1")
    peers[stopped].process.send_signal(signal.SIGCONT)
    await_lines(peers[other], gone, "nodes a b publishers 2", f"echo {stopped}")
    await_lines(peers[stopped], since[1 - place], f"state {other} 6")
    for peer, name in ((peers["a"], "b"), (peers["b"], "a")):
        numbers = heard(peer, name)
        assert numbers == sorted(set(numbers))
        assert {3, 4, 5} <= set(numbers)


@pytest.mark.slow
def test_a_killed_process_that_starts_again_gets_what_others_keep(machine: Machine) -> None:
    one = machine.run("a", program=PROGRAM)
    since = await_lines(one, 0, "nodes a publishers 1")
    for round in range(3):
        other = machine.run("b", program=PROGRAM)
        since, _ = meet(one, other, 5, (since, 0))
        await_lines(other, 0, *(f"state a {number + round}" for number in (3, 4, 5)))
        numbers = heard(other, "a")  # three that were kept; the last one may have come by itself
        assert numbers in ([*range(first, 6 + round)] for first in (2 + round, 3 + round))
        other.process.kill()
        other.process.wait()
        since = await_lines(one, since, "nodes a publishers 1")
    assert [heard(one, "b").count(number) for number in (3, 4, 5)] == [3, 3, 3]


@pytest.mark.slow
def test_a_killed_router_that_starts_again_takes_nothing_away(site: Site, endpoints: list[str]) -> None:
    address = endpoints[0]
    router = site.router("--listen", address)
    one, other = (site.program(PROGRAM, name, at=address) for name in "ab")
    since = meet(one, other, 5)
    for round in range(2):
        router.process.kill()
        router.process.wait()
        since = [
            await_lines(peer, begin, f"nodes {name} publishers 1")
            for peer, name, begin in zip((one, other), "ab", since, strict=True)
        ]
        router = site.router("--listen", address)
        since = meet(one, other, 6 + round, since)
    for peer, name in ((one, "b"), (other, "a")):
        numbers = heard(peer, name)
        assert numbers == sorted(set(numbers))
        assert numbers[-3:] == [5, 6, 7]
