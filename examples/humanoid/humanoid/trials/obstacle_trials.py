"""Walks between obstacles that the robot must find with its camera: for tests and benchmarks."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Point
from humanoid_interfaces.msg import ObstacleMotion

from ..robot.obstacles import Solid, random_solids
from ..spatial import Array
from .graph import NodeGraph
from .user import ScenarioError, User

GOAL = (4.0, 0.0, 0.0)
AREA = (0.6, -1.2, 3.4, 1.2)
"""Where obstacles stand: x and y from, x and y to [m], between the robot and its goal."""

_LONGEST = 150.0  # s of simulated time
_LOOK = 0.2  # s
_ON_ITS_WAY = 1.0  # m from the start where an obstacle is moved
_AHEAD = (
    1.2,
    1.4,
    1.6,
    1.8,
    2.0,
)  # m in front of the robot where it may be put, where there is room round it
_BEHIND = 0.5  # m of its way that say where it is heading
_APART, _FREE = 1.1, 0.85  # m from other obstacles, and from the goal, as in the scenes


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
    moved: bool = False


def scene(seed: int) -> tuple[Solid, ...]:
    """Five obstacles at random places."""
    return random_solids(seed, 5, AREA, [(0.0, 0.0), GOAL[:2]])


def walk_through(seed: int, *, moving: bool = False) -> Scene:
    """Let the robot walk to GOAL in a scene that it does not know.

    `moving`: on its way an obstacle is put in front of it, if there is a place that leaves a way round.
    """
    walk = _Walk(scene(seed), moving=moving)
    with NodeGraph(seed=seed, solids=walk.solids, sees=True) as graph:
        try:
            played = graph.play(walk.play)
        except ScenarioError as problem:
            reason, seconds = str(problem), graph.user.now
        else:
            reason, seconds = played.result, played.simulated
        score = graph.user.score
        error = graph.user.distance_to(*GOAL[:2])
        return Scene(
            seed,
            len(walk.solids),
            not reason,
            score.falls,
            score.touches,
            error,
            score.distance,
            seconds,
            reason,
            walk.moved,
        )


def walks(seeds: Iterable[int], *, moving: bool = False) -> list[Scene]:
    """One walk for each seed."""
    return [walk_through(seed, moving=moving) for seed in seeds]


class _Walk:
    """A walk to GOAL, on which an obstacle may be moved."""

    def __init__(self, solids: tuple[Solid, ...], *, moving: bool) -> None:
        self.solids = solids
        self.moved = False
        self._moving = moving
        self._places: list[Array] = []  # where the robot has been, each (2,)

    async def play(self, user: User) -> str:
        """Walk; returns why that did not succeed, or ""."""
        mover = user.create_publisher(ObstacleMotion, "/humanoid_simulator/move_obstacle", 10)
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
            self._places.append(user.place[:2])
            motion = self._ahead() if self._moving and not self.moved else None
            if motion is not None:
                mover.publish(motion)
                self.moved = True
        answer = result.result()
        return "" if answer.status == GoalStatus.STATUS_SUCCEEDED else str(answer.result.message)

    def _ahead(self) -> ObstacleMotion | None:
        """The motion of an obstacle to a place in front of the robot that leaves a way round it, if any."""
        here = self._places[-1]
        behind = [place for place in self._places if math.dist(place, here) > _BEHIND]
        if math.dist(here, self._places[0]) < _ON_ITS_WAY or not behind:
            return None
        way = (here - behind[-1]) / math.dist(here, behind[-1])
        for distance, solid in itertools.product(_AHEAD, self.solids):
            x, y = (here + distance * way).tolist()
            others = [(other.x, other.y) for other in self.solids if other is not solid]
            free = all(math.dist((x, y), place) > _APART for place in others)
            if free and distance < math.dist(here, GOAL[:2]) and math.dist((x, y), GOAL[:2]) > _FREE:
                return ObstacleMotion(name=solid.name, position=Point(x=x, y=y))
        return None
