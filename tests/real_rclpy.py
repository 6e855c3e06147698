"""What real rclpy does now and then, whatever runs on it."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import TypeVar

Ended = TypeVar("Ended")

CRASHED = 128 + signal.SIGSEGV


def again_if_crashed(
    transport: str, run: Callable[[], Ended], code_of: Callable[[Ended], int | None]
) -> Ended:
    """Run programs on a transport; on rclpy again, twice at most, if rclpy crashed while they were interrupted.

    Its own thread for signals may trigger a guard condition that a program has just destroyed
    (`rcl_trigger_guard_condition`): about 1 in 40 interruptions on a busy machine.
    """
    ended = run()
    for _ in range(2):
        if transport == "local" or code_of(ended) != CRASHED:
            break
        ended = run()
    return ended
