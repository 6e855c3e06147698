"""A route for the body between two places, round what is on the floor: A*, and then a string pulled tight.

The floor is given by the points where something stands. A place is free if no point is within the clearance.
Where the straight line is free, it is the route. Otherwise the search runs on a coarse grid, whose cells cost
more near an obstacle, and the corners that are left are those that a line in between would cut.
"""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..robot.grid import nearest
from ..robot.ground import Obstacle
from ..spatial import Array

Place = tuple[float, float]

CLEARANCE = 0.40
"""From the middle of the body to what is on the floor [m]: its half width, swaying, and errors of the map."""

_CELL = 0.10  # m
_MARGIN = 2.5  # m around start and goal that the search looks at
_LARGEST = 200_000  # cells that it looks at
_NEAR, _PRICE = 0.25, 2.0  # m beyond the clearance within which a way costs up to this much more
_ESCAPE = 20.0  # price of a cell within the clearance, to leave it from where the robot stands
_BODY = 0.20  # m: with something this near the robot cannot go on
_FARTHEST = 1000.0  # m from the origin
_SAMPLE = 0.04  # m between the points at which a line is examined
_NEIGHBOURS = [(r, c, math.hypot(r, c)) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]


class RouteStatus(IntEnum):
    """The outcome of planning, as in PlanPath.srv."""

    UNKNOWN = 0
    PLANNED = 1
    GOAL_OCCUPIED = 2
    BLOCKED = 3
    UNKNOWN_FRAME = 4
    INVALID_REQUEST = 5


@dataclass(frozen=True, slots=True)
class Route:
    """A polyline from start to goal, or why there is none."""

    status: RouteStatus
    message: str
    places: tuple[Place, ...] = ()

    @property
    def length(self) -> float:
        """In metres."""
        return sum(itertools.starmap(math.dist, itertools.pairwise(self.places)))


def disc_points(obstacle: Obstacle) -> Array:
    """Points (n, 2) that stand for a disc."""
    radii = np.arange(obstacle.radius, 0.0, -0.1)
    angles = np.linspace(0.0, 2 * math.pi, 24, endpoint=False)
    x = obstacle.x + np.outer(radii, np.cos(angles)).ravel()
    y = obstacle.y + np.outer(radii, np.sin(angles)).ravel()
    return np.stack([x, y], axis=1)


def plan_route(
    start: Place, goal: Place, points: Array, clearance: float = CLEARANCE, *, search: bool = True
) -> Route:
    """A route between two places round points (n, 2); without `search` only the straight line will do."""
    if not all(map(math.isfinite, (*start, *goal))):
        return Route(RouteStatus.INVALID_REQUEST, "start or goal holds a number that is not finite")
    if max(map(abs, (*start, *goal))) > _FARTHEST:
        return Route(RouteStatus.INVALID_REQUEST, f"start or goal is more than {_FARTHEST:g} m away")
    near = float(nearest(points, np.array([goal]))[0])
    if near < clearance - _CELL / 2:
        text = f"the goal ({goal[0]:.2f}, {goal[1]:.2f}) is {near:.2f} m from an obstacle"
        return Route(RouteStatus.GOAL_OCCUPIED, f"{text}; I keep {clearance:g} m")
    if _is_free(start, goal, points, clearance):
        return Route(RouteStatus.PLANNED, "", (start, goal))
    if not search:
        return Route(
            RouteStatus.BLOCKED, "there is an obstacle on the straight line, and I look for no other"
        )
    if nearest(points, np.array([start]))[0] < _BODY:
        text = "an obstacle is where the robot stands, or so near that it cannot move"
        return Route(RouteStatus.BLOCKED, text)
    places = _search(start, goal, points, clearance)
    if places is None:
        text = f"no way of {2 * clearance:.2f} m width leads to ({goal[0]:.2f}, {goal[1]:.2f})"
        return Route(RouteStatus.BLOCKED, text)
    return Route(RouteStatus.PLANNED, "", _pulled(places, points, clearance))


def _is_free(start: Place, goal: Place, points: Array, clearance: float) -> bool:
    return bool(_room(start, goal, points) >= clearance)


def _room(start: Place, goal: Place, points: Array) -> float:
    """The distance of a straight line from the nearest point."""
    if not len(points):
        return math.inf
    count = max(2, math.ceil(math.dist(start, goal) / _SAMPLE) + 1)
    line = np.linspace(start, goal, count)
    low, high = line.min(axis=0) - 1.0, line.max(axis=0) + 1.0
    around = points[((points >= low) & (points <= high)).all(axis=1)]
    return float(nearest(around, line).min()) if len(around) else 1.0


def _search(start: Place, goal: Place, points: Array, clearance: float) -> list[Place] | None:
    """The cheapest way over the cells of a grid, by A*; None if there is none."""
    corner = np.minimum(start, goal) - _MARGIN
    columns, rows = np.ceil((np.maximum(start, goal) + _MARGIN - corner) / _CELL).astype(int).tolist()
    if rows * columns > _LARGEST:
        return None
    y, x = np.mgrid[:rows, :columns]
    middles = corner + (np.stack([x.ravel(), y.ravel()], axis=1) + 0.5) * _CELL
    room = np.concatenate(
        [nearest(points, part) for part in np.array_split(middles, 1 + len(middles) // 500)]
    )
    price = 1.0 + _PRICE * np.clip(1.0 - (room - clearance) / _NEAR, 0.0, 1.0)
    price[room < clearance] = _ESCAPE
    price[room < _BODY] = math.inf

    def cell(place: Place) -> int:
        column, row = ((np.array(place) - corner) // _CELL).astype(int).tolist()
        return int(row * columns + column)

    begin, end = cell(start), cell(goal)
    prices: list[float] = price.tolist()
    left_start = room >= clearance  # once it has left the clearance, it does not enter it again
    end_row, end_column = divmod(end, columns)
    best, before = {begin: 0.0}, {begin: begin}
    ahead = [(0.0, begin)]
    done: set[int] = set()
    while ahead:
        _, here = heapq.heappop(ahead)
        if here == end:
            break
        if here in done:
            continue
        done.add(here)
        row, column = divmod(here, columns)
        for down, right, step in _NEIGHBOURS:
            if not (0 <= row + down < rows and 0 <= column + right < columns):
                continue
            there = here + down * columns + right
            if left_start[here] and not left_start[there] and there != end:
                continue
            cost = best[here] + step * prices[there]
            if cost < best.get(there, math.inf):
                best[there], before[there] = cost, here
                rest = math.hypot(row + down - end_row, column + right - end_column)
                heapq.heappush(ahead, (cost + rest, there))
    if end not in before:
        return None
    way = [end]
    while way[-1] != begin:
        way.append(before[way[-1]])
    inner = [(float(middles[number, 0]), float(middles[number, 1])) for number in way[-2:0:-1]]
    return [start, *inner, goal]


def _pulled(places: list[Place], points: Array, clearance: float) -> tuple[Place, ...]:
    """The corners that stay when the way is pulled tight, without coming nearer to anything than it was."""
    kept = [places[0]]
    here = 0
    while here < len(places) - 1:
        for there in range(len(places) - 1, here, -1):
            usual = nearest(points, np.array(places[here : there + 1])).min()
            if there == here + 1 or _room(places[here], places[there], points) >= min(
                float(usual), clearance + _CELL / 2
            ):
                kept.append(places[there])
                here = there
                break
    return tuple(kept)
