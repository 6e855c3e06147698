"""Walks between obstacles that the robot must find with its camera: for tests and benchmarks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from action_msgs.msg import GoalStatus

from ..robot.obstacles import Solid, random_solids
from .graph import NodeGraph
from .user import ScenarioError, User

GOAL = (4.0, 0.0, 0.0)
AREA = (0.6, -1.2, 3.4, 1.2)
"""Where obstacles stand: x and y from, x and y to [m], between the robot and its goal."""

_LONGEST = 150.0  # s of simulated time
_LOOK = 0.2  # s


@dataclass(frozen=True, slots=True)
class Scene:
    """How a walk to GOAL between obstacles ended; lengths in metres, times in simulated seconds."""

    seed: int
    obstacles: int
    reached: bool
    falls: int
    touches: int
    error: float
    length: float
    seconds: float
    reason: str = ""


def scene(seed: int) -> tuple[Solid, ...]:
    """Five obstacles at random places."""
    return random_solids(seed, 5, AREA, [(0.0, 0.0), GOAL[:2]])


def walk_through(seed: int) -> Scene:
    """Let the robot walk to GOAL in a scene that it does not know."""
    solids = scene(seed)
    with NodeGraph(seed=seed, solids=solids, sees=True) as graph:
        try:
            played = graph.play(_walk)
        except ScenarioError as problem:
            reason, seconds = str(problem), graph.user.now
        else:
            reason, seconds = played.result, played.simulated
        score = graph.user.score
        error = graph.user.distance_to(*GOAL[:2])
        return Scene(
            seed,
            len(solids),
            not reason,
            score.falls,
            score.touches,
            error,
            score.distance,
            seconds,
            reason,
        )


def walks(seeds: Iterable[int]) -> list[Scene]:
    """One walk for each seed."""
    return [walk_through(seed) for seed in seeds]


async def _walk(user: User) -> str:
    """Walk to GOAL; returns why that did not succeed, or ""."""
    await user.wait(1.0)  # for the first pictures
    handle = await user.begin_walk(*GOAL)
    result = handle.get_result_async()
    began = user.now
    while not result.done():
        await user.wait(_LOOK)
        if user.fallen:
            return "the robot has fallen"
        if user.now - began > _LONGEST:
            return f"not there after {_LONGEST:.0f} s"
    answer = result.result()
    return "" if answer.status == GoalStatus.STATUS_SUCCEEDED else str(answer.result.message)
