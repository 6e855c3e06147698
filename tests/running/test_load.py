"""Many nodes, and publishers that are faster than those who listen: what it costs is bounded."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from tests.running.terminals import Machine
from tests.running.test_hostile import resident

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)
pytestmark = pytest.mark.slow

PEERS = Path(__file__).parent / "peers"
PROCESSES, NODES = 10, 5
DEPTH = 5
GROWTH = 80  # [MB]: what Zenoh has in its queues, 100 kB a message
OF_NODES = 40  # [MB]: Zenoh, and fifty nodes with about a dozen endpoints each


def test_fifty_nodes_in_ten_processes_see_each_other(machine: Machine) -> None:
    everybody = str(PROCESSES * NODES)
    alone = machine.run(
        "alone", "1", "1", program=str(PEERS / "many.py"), ROS_AUTOMATIC_DISCOVERY_RANGE="OFF"
    )
    alone.until("sees all")
    least = resident(alone.process.pid)
    begun = time.monotonic()
    running = [
        machine.run(f"p{number}", str(NODES), everybody, program=str(PEERS / "many.py"))
        for number in range(PROCESSES)
    ]
    seen = [each.until("sees all") for each in running]
    took = time.monotonic() - begun
    memory = [resident(each.process.pid) for each in running]
    print(f"{took:.1f} s in all; since init, CPU [s]: {seen}; resident {memory}, alone {least} [MB]")
    assert max(memory) < least + OF_NODES
    running[0].process.kill()
    killed = time.monotonic()
    for each in running[1:]:
        each.until("sees fewer")
    took = time.monotonic() - killed
    print(f"a killed process is gone for all others after {took:.2f} s")
    assert took < 1.0
    for each in running[1:]:
        assert each.end() == 0


def test_a_publisher_that_is_too_fast_fills_no_memory(machine: Machine) -> None:
    fast = str(PEERS / "fast.py")
    listener, talker = machine.run("listen", program=fast), machine.run("talk", program=fast)
    while len(listener.until("heard").split()) < DEPTH + 1:
        pass
    both = (listener, talker)
    before = [resident(each.process.pid) for each in both]
    bursts = [listener.until("heard") for _ in range(10)]
    after = [resident(each.process.pid) for each in both]
    print(f"{bursts[-1]}; resident before and after: {before}, {after} [MB]")
    for burst in bursts:
        numbers = [int(number) for number in burst.split()[1:]]
        assert len(numbers) == DEPTH
        assert numbers == sorted(set(numbers))
    assert int(bursts[-1].split()[-1]) > 10 * DEPTH * 2  # the listener has missed most of them
    assert all(now - then < GROWTH for now, then in zip(after, before, strict=True))
