"""The scenarios of the demo: each is a coroutine that a director plays."""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable

from ..data import Mode
from .director import Director

Scenario = Callable[[Director], Awaitable[None]]

STANDING_PUSH, WALKING_PUSH = 4.0, 3.0  # N s


async def walk(director: Director) -> None:
    """Walk to a goal and turn, walk part of the way back and cancel that."""
    await director.walk(1.0, 0.5, math.pi / 2)
    handle = await director.begin_walk(0.0, 0.0, 0.0)
    await director.wait(4.0)
    await director.cancel(handle)


async def dance(director: Director) -> None:
    """One dance after another."""
    for name in ("wave", "disco"):
        await director.dance(name)


async def push(director: Director) -> None:
    """Push the robot from all sides while it stands and while it walks."""
    for quarter in range(4):
        director.push(STANDING_PUSH, quarter * math.pi / 2)
        await director.wait(3.0)
    handle = await director.begin_walk(1.2, 0.0, 0.0)
    for quarter in range(3):
        await director.wait(1.9)
        director.push(WALKING_PUSH, math.pi / 3 + quarter * 2 * math.pi / 3)
    await director.end_of(handle)


async def stop(director: Director) -> None:
    """Press the emergency stop in the middle of a walk, release it and walk on."""
    handle = await director.begin_walk(1.0, 0.0, 0.0)
    await director.wait(3.0)
    await director.emergency_stop(True)
    await director.end_of(handle)
    await director.wait(2.0)
    await director.emergency_stop(False)
    await director.until(Mode.STANDING)
    await director.walk(0.6, 0.3, 0.0)


async def everything(director: Director) -> None:
    """Stand, walk, turn, push, dance and stop."""
    await director.wait(1.0)
    await director.walk(1.0, 0.5, math.pi / 2)
    director.push(STANDING_PUSH, math.pi)
    await director.wait(2.0)
    await director.dance("wave")
    handle = await director.begin_walk(0.0, 0.5, math.pi)
    await director.wait(4.0)
    director.push(WALKING_PUSH, math.pi / 2)
    await director.wait(1.0)
    await director.cancel(handle)
    await director.begin_walk(0.0, 1.0, 0.0)
    await director.wait(3.0)
    await director.emergency_stop(True)
    await director.wait(2.0)


SCENARIOS: dict[str, Scenario] = {
    "all": everything,
    "walk": walk,
    "dance": dance,
    "push": push,
    "stop": stop,
}
