"""A server that is killed before it answers: the future of its client fails at once, and the client goes on."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from tests.running.terminals import Machine

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)

REQUESTS = str(Path(__file__).parent / "peers/requests.py")


def test_a_killed_server_fails_what_it_was_asked(machine: Machine) -> None:
    server, client = (machine.run(role, program=REQUESTS) for role in ("hold", "ask"))
    client.until("asked")
    for _ in range(2):  # a goal and a request
        server.until("held")
    server.process.kill()
    killed = time.monotonic()
    told = [client.until("failed", limit=5.0) for _ in range(2)]
    assert (
        time.monotonic() - killed < 5.0
    )  # milliseconds; a connection that is only silent is given up after 10 s
    for line, what in zip(told, ("service '/switch'", "get_result of action '/compute'"), strict=True):
        assert line.startswith(f"failed ServerGoneError {what}: no response will come from /hold")
    again = machine.run("answer", program=REQUESTS)
    client.until("answered")
    assert client.process.wait(10.0) == 0
    assert again.end() == 0
