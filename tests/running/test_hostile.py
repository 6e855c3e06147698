"""Two programs that talk on while a third peer sends garbage at full speed."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from tests.running.terminals import Machine

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)

HOSTILE = Path(__file__).parent / "peers/hostile.py"
INT64 = "RIHS01_8cd1048c2f186b6bd9a92472dc1ce51723c0833a221e2b7aecfff111774f4b49"
TOKENS = 2000
FLOOD = 10  # [s]
RATE = 50  # [1/s], of the talker
GROWTH = 150  # [MB]: Zenoh keeps 1 to 4 kB of each token that it has seen, however short its life
WAS_HERE = Path("/tmp/ifgen-was-here")


@pytest.mark.slow
def test_garbage_at_full_speed_is_refused_and_counted(machine: Machine) -> None:
    talker, listener = machine.run("t", "talk"), machine.run("l", "listen")
    listener.until("heard")
    honest = (talker, listener)
    before = [resident(each.process.pid) for each in honest]
    words = [str(machine.folder), INT64, str(TOKENS)]
    hostile = subprocess.Popen(
        [sys.executable, HOSTILE, machine.environment["ROS_DOMAIN_ID"], *words],
        stdout=subprocess.PIPE,
        text=True,
    )
    with hostile:
        assert hostile.stdout is not None
        begun = time.monotonic()
        sent = ""
        while time.monotonic() - begun < FLOOD:
            sent = hostile.stdout.readline()
        after = [resident(each.process.pid) for each in honest]
        lines = [line.split() for line in listener.so_far() if line.startswith("heard")]
        numbers = [int(words[1]) for words in lines if words[1:] and words[1].isdecimal()]  # among warnings
        hostile.kill()
    print(f"tokens, messages, requests, answers: {sent}; resident before and after: {before}, {after} [MB]")
    assert all(int(number) > 100 for number in sent.split()[1:4])
    listener.until("nodes l t")
    assert max(numbers) > FLOOD * RATE / 2  # the talker's; those of the peer are 0
    for _ in range(3):
        listener.until("heard")
    for each in honest:
        assert each.end() == 0
        reasons = Counter(
            line.split(":")[1][:30] for line in each.lines if line.startswith("rmw_local: dropped")
        )
        assert reasons
        assert max(reasons.values()) <= FLOOD + 3
        assert not any("\x1b" in line for line in each.lines)
    assert all(now - then < GROWTH for now, then in zip(after, before, strict=True))
    assert not WAS_HERE.exists()


def resident(process: int) -> int:
    """Memory in use [MB]."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(line.split()[1]) // 1024 for line in lines if line.startswith("VmRSS:"))
