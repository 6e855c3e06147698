"""Two machines with a cable between them: namespaces of the network, which end with the processes that hold them."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import pytest

_HOLD = ("sh", "-c", "echo ready; exec sleep 300")


@dataclass(frozen=True)
class Machine:
    """`enter` is what a command begins with that runs there."""

    enter: tuple[str, ...]
    address: str


@contextmanager
def two_machines() -> Iterator[tuple[Machine, Machine]]:
    """Make them, or skip the test where that is not allowed."""
    with ExitStack() as stack:
        one = _hold(stack, ("unshare", "--user", "--map-root-user", "--net"), "10.255.0.1")
        other = _hold(stack, (*one.enter, "unshare", "--net"), "10.255.0.2")
        target = other.enter[2]
        _ip(one, "link", "add", "name", "cable", "type", "veth", "peer", "name", "cable", "netns", target)
        for machine in (one, other):
            _ip(machine, "address", "add", f"{machine.address}/24", "dev", "cable")
            for device in ("lo", "cable"):
                _ip(machine, "link", "set", device, "up")
        yield one, other


def _hold(stack: ExitStack, command: tuple[str, ...], address: str) -> Machine:
    try:
        holder = subprocess.Popen(
            [*command, *_HOLD], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
    except FileNotFoundError as error:
        pytest.skip(f"no namespaces: {error}")
    stack.enter_context(holder)
    stack.callback(holder.kill)
    assert holder.stdout is not None
    assert holder.stderr is not None
    if holder.stdout.readline() != "ready\n":
        pytest.skip(f"no namespaces: {holder.stderr.read().strip()}")
    enter = ("nsenter", "--target", str(holder.pid), "--user", "--net", "--preserve-credentials")
    return Machine(enter, address)


def _ip(machine: Machine, *words: str) -> None:
    done = subprocess.run(
        [*machine.enter, "ip", *words], capture_output=True, text=True, timeout=60, check=False
    )
    if done.returncode:
        pytest.skip(f"no network between namespaces: {done.stderr.strip()}")
