"""What real rclpy does now and then, whatever runs on it."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import TypeVar

Ended = TypeVar("Ended")

CRASHED, KILLED = 128 + signal.SIGSEGV, 128 + signal.SIGKILL


def again_if_crashed(
    transport: str, run: Callable[[], Ended], code_of: Callable[[Ended], int | None]
) -> Ended:
    """Run programs on a transport; on rclpy again, twice at most, if rclpy did not let them end in peace.

    It crashes in about 1 in 40 interruptions on a busy machine: its own thread for signals may trigger a guard
    condition that a program has just destroyed (`rcl_trigger_guard_condition`). Where many nodes leave at once,
    about 1 in 150 hangs for ever in Fast DDS, which waits for its own callbacks before it destroys a
    participant (`DomainParticipant::set_listener`), and has to be killed.
    """
    ended = run()
    for _ in range(2):
        if transport == "local" or code_of(ended) not in (CRASHED, KILLED):
            break
        ended = run()
    return ended
