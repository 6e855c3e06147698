"""A listener that is stopped: what does not reach it is counted, sent again where it is kept, and never acknowledged."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.running.terminals import Machine

pytest.importorskip("zenoh")

PROGRAM = str(Path(__file__).parent / "peers/stopping.py")
RELIABLE, BEST_EFFORT = "1", "2"
TRANSIENT_LOCAL, VOLATILE = "1", "2"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("reliability", "durability", "loses", "acked"),
    [
        # The last word: some of the last 1000 messages are missing for ever.
        (RELIABLE, VOLATILE, "lost", "True False False"),
        (BEST_EFFORT, VOLATILE, "lost", "True True True"),
        (RELIABLE, TRANSIENT_LOCAL, "nothing lost", "True False True"),
    ],
    ids=["reliable", "best_effort", "durable"],
)
def test_every_message_is_heard_or_counted_as_lost(
    machine: Machine, reliability: str, durability: str, loses: str, acked: str
) -> None:
    listener = machine.run("listen", reliability, durability, program=PROGRAM)
    listener.until("listening")
    talker = machine.run("talk", reliability, durability, str(listener.process.pid), program=PROGRAM)
    assert talker.until("acked") == f"acked {acked} in time"
    assert listener.until("sum") == f"sum 402 {loses}"
