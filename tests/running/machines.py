"""Two machines with a cable between them: namespaces, which end with the processes that hold them."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest

# Processes of one machine meet in a folder there: each has its own.
_FOLDER = "/tmp/ifgen-0"  # of root, which everybody is in a namespace of users
_OWN_FOLDER = f"mkdir -m 700 -p {_FOLDER}; mount -t tmpfs -o mode=700 none {_FOLDER}"
_LOSSY = str(Path(__file__).parent / "peers/cable.py")
_HOLD = ("sh", "-c", f"{_OWN_FOLDER} && echo ready && exec sleep 300")


@dataclass(frozen=True)
class Machine:
    """`enter` is what a command begins with that runs there."""

    enter: tuple[str, ...]
    address: str


@contextmanager
def two_machines() -> Iterator[tuple[Machine, Machine]]:
    """Make them, or skip the test where that is not allowed."""
    with _connected(_plug_in) as machines:
        yield machines


@contextmanager
def two_far_machines(*, delay: float, loss: float) -> Iterator[tuple[Machine, Machine]]:
    """Make them with a cable that is late [s] and loses a share of the packets, in both directions.

    `tc netem` does the same with a module that many kernels lack.
    """
    with _connected(partial(_plug_in_lossy, delay=delay, loss=loss)) as machines:
        yield machines


@contextmanager
def _connected(
    plug_in: Callable[[ExitStack, Machine, Machine], None],
) -> Iterator[tuple[Machine, Machine]]:
    with ExitStack() as stack:
        one = _hold(stack, ("unshare", "--user", "--map-root-user", "--net", "--mount"), "10.255.0.1")
        other = _hold(stack, (*one.enter, "unshare", "--net", "--mount"), "10.255.0.2")
        plug_in(stack, one, other)
        for machine in (one, other):
            _ip(machine, "address", "add", f"{machine.address}/24", "dev", "cable")
            for device in ("lo", "cable"):
                _ip(machine, "link", "set", device, "up")
        for machine in (one, other):  # an address is looked for elsewhere before it can be used
            while _ip(machine, "-6", "address", "show", "dev", "cable", "tentative"):
                time.sleep(0.05)
        yield one, other


def _plug_in(_: ExitStack, one: Machine, other: Machine) -> None:
    target = other.enter[2]
    _ip(one, "link", "add", "name", "cable", "type", "veth", "peer", "name", "cable", "netns", target)


def _plug_in_lossy(stack: ExitStack, one: Machine, other: Machine, *, delay: float, loss: float) -> None:
    ends = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)  # keeps packets apart
    for seed, (machine, end) in enumerate(zip((one, other), ends, strict=True)):
        words = [str(word) for word in (end.fileno(), delay, loss, seed)]
        with end:
            carrier = _started(
                stack, (*machine.enter, sys.executable, _LOSSY, *words), pass_fds=(end.fileno(),)
            )
        if (line := carrier.stdout.readline()) != "ready\n":
            pytest.skip(f"no network devices of programs: {line}{carrier.stderr.read().strip()}")


def _hold(stack: ExitStack, command: tuple[str, ...], address: str) -> Machine:
    holder = _started(stack, (*command, *_HOLD))
    if holder.stdout.readline() != "ready\n":
        pytest.skip(f"no namespaces: {holder.stderr.read().strip()}")
    enter = ("nsenter", "--target", str(holder.pid), "--user", "--net", "--mount", "--preserve-credentials")
    return Machine(enter, address)


def _started(stack: ExitStack, command: tuple[str, ...], **options: Any) -> Any:
    """Start a process that is killed at the end, with pipes for what it prints."""
    try:
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
        )
    except FileNotFoundError as error:
        pytest.skip(f"no namespaces: {error}")
    stack.enter_context(process)
    stack.callback(process.kill)
    return process


def _ip(machine: Machine, *words: str) -> str:
    """What `ip` prints there."""
    done = subprocess.run(
        [*machine.enter, "ip", *words], capture_output=True, text=True, timeout=60, check=False
    )
    if done.returncode:
        pytest.skip(f"no network between namespaces: {done.stderr.strip()}")
    return done.stdout
