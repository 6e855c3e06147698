"""The tree of frames: which transforms lie between two of them, and the velocity of one seen from another."""

from __future__ import annotations

import math
from typing import TypeAlias

from tf2_py.caches import Cache, Edge, StaticCache, TimeCache
from tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    LookupException,
    TransformException,
)
from tf2_py.transforms import IDENTITY, Transform, Vector, compose, invert, normalized, rotate

# A path of more transforms to a root is a loop.
MAX_GRAPH_DEPTH = 1000


class FrameTree:
    """Frames by name, each with its transforms to a parent. The caller holds a lock.

    :param cache_time: how long transforms are kept, in nanoseconds.
    """

    def __init__(self, cache_time: int) -> None:
        self._cache_time = cache_time
        # In the order in which they were heard of. A frame that is only a parent has no cache.
        self.frames: dict[str, Cache | None] = {}
        self.authorities: dict[str, str] = {}

    def insert(self, child: str, edge: Edge, stamp: int, *, is_static: bool) -> bool:
        """Store a transform; return False if it is too old."""
        cache = self.frames.get(child)
        if cache is None or cache.is_static is not is_static:
            cache = StaticCache() if is_static else TimeCache(self._cache_time)
            self.frames[child] = cache
        self.frames.setdefault(edge[0], None)
        return cache.insert(stamp, edge)

    def clear(self) -> None:
        """Forget what may change, keep the frames and what is static."""
        for cache in self.frames.values():
            if cache is not None:
                cache.clear()

    def latest_stamp(self, frame: str) -> int:
        """Return the time of a frame's latest transform; 0 if it is static, or there is none."""
        cache = self.frames.get(frame)
        return 0 if cache is None else cache.latest

    def lookup(self, target: str, source: str, stamp: int) -> tuple[Transform, int]:
        """Return the transform from source to target, and its time.

        For the time 0 that is the latest that all on the way have.

        :raises ConnectivityException: if they are in different trees.
        :raises ExtrapolationException: if something on the way has no transform for this time.
        :raises LookupException: if the tree is a loop.
        """
        if target == source:
            return IDENTITY, stamp or self.latest_stamp(target)
        stamp = stamp or self.latest_common_time(target, source)
        ups, downs = self.walk(target, source, stamp)
        result = IDENTITY
        for _, transform in ups:
            result = compose(transform, result)
        if downs:
            way_back = IDENTITY
            for _, transform in downs:
                way_back = compose(transform, way_back)
            result = compose(invert(way_back), result)
        return normalized(result) or result, stamp

    def why_not(self, target: str, source: str, stamp: int) -> str:
        """Return why there is no transform from source to target; empty if there is one."""
        if target != source:
            try:
                self.walk(target, source, stamp or self.latest_common_time(target, source))
            except TransformException as error:
                return str(error)
        return ""

    def walk(self, target: str, source: str, stamp: int) -> tuple[list[Edge], list[Edge]]:
        """Return the transforms on the way up from the source, and from the target, to where these meet.

        One is empty if a frame is above the other.
        """
        ups: list[Edge] = []
        edge: Edge | None
        stuck: Cache | None = None
        frame = source
        while frame != target:
            cache = self.frames.get(frame)
            if cache is None:  # the root
                break
            edge = cache.at(stamp)
            if edge is None:  # there may still be a way: the target's could lead here
                stuck = cache
                break
            ups.append(edge)
            frame = edge[0]
            if len(ups) > MAX_GRAPH_DEPTH:
                raise self._loop()
        else:
            return ups, []
        top = frame
        downs: list[Edge] = []
        frame = target
        while frame != top:
            if frame == source:
                return [], downs
            cache = self.frames.get(frame)
            if cache is None:
                if stuck is not None:
                    raise self._extrapolation(stuck, stamp, target, source)
                raise self._unconnected(target, source)
            edge = cache.at(stamp)
            if edge is None:
                raise self._extrapolation(cache, stamp, target, source)
            downs.append(edge)
            frame = edge[0]
            if len(downs) > MAX_GRAPH_DEPTH:
                raise self._loop()
        return ups, downs

    def latest_common_time(self, target: str, source: str) -> int:
        """Return the latest time for which all on the way have a transform; 0 if all are static."""
        if target == source:
            return self.latest_stamp(source)
        times: list[int] = []  # of the source's ancestors
        place: dict[str, int] = {}  # of a frame among them
        frame = source
        while (latest := self._newest(frame)) is not None:
            stamp, frame = latest
            times.append(stamp)
            place.setdefault(frame, len(times))
            if frame == target:
                return _earliest(times)
            if len(times) > MAX_GRAPH_DEPTH:
                raise self._loop()
        own: list[int] = []
        frame = target
        while (latest := self._newest(frame)) is not None:
            stamp, frame = latest
            own.append(stamp)
            if frame in place:
                return _earliest(own + times[: place[frame]])
            if frame == source:
                return _earliest(own)
            if len(own) > MAX_GRAPH_DEPTH:
                raise self._loop()
        raise self._unconnected(target, source)

    def chain(self, fixed: str, frame: str, stamp: int) -> list[str]:
        """Return the names of the frames on the way from `frame` to `fixed`, both included."""
        stamp = stamp or self.latest_common_time(fixed, frame)
        ups, downs = self.walk(fixed, frame, stamp)
        names = [frame, *(parent for parent, _ in ups)]
        others = [fixed, *(parent for parent, _ in downs)]
        return without_detour(names, others)

    def _newest(self, frame: str) -> tuple[int, str] | None:
        cache = self.frames.get(frame)
        edge = None if cache is None else cache.newest_edge
        return None if cache is None or edge is None else (cache.latest, edge[0])

    def as_string(self) -> str:
        """Return a line for each frame that has had a parent."""
        lines: list[str] = []
        for name, cache in self.frames.items():
            if cache is not None:
                edge = cache.newest_edge
                lines.append(f"Frame {name} exists with parent {edge[0] if edge else 'NO_PARENT'}.\n")
        return "".join(lines)

    def _loop(self) -> LookupException:
        return LookupException(f"The tf tree is invalid because it contains a loop.\n{self.as_string()}\n")

    def _unconnected(self, target: str, source: str) -> ConnectivityException:
        return ConnectivityException(
            f"Could not find a connection between '{target}' and '{source}' because they are not part of the "
            "same tree.Tf has two or more unconnected trees."
        )

    def _extrapolation(self, cache: Cache, stamp: int, target: str, source: str) -> ExtrapolationException:
        return ExtrapolationException(
            f"{cache.why_not(stamp)}, when looking up transform from frame [{source}] to frame [{target}]"
        )


def without_detour(there: list[str], back: list[str]) -> list[str]:
    """Join two ways that end at the same frame, `back` reversed, at the first frame that they share."""
    there, back = list(there), list(back)
    while len(there) > 1 and len(back) > 1 and there[-2] == back[-2]:
        there.pop()
        back.pop()
    return [*there, *reversed(back[:-1])]


def _earliest(times: list[int]) -> int:
    """The earliest time; 0, which static transforms have, does not count."""
    return min(filter(None, times), default=0)


# Linear [m/s] and angular [rad/s].
Twist: TypeAlias = tuple[Vector, Vector]

# What upstream leaves between the interval and time 0, which would ask for the latest transform [s].
_MARGIN = 0.00001


def twist_between(
    tree: FrameTree,
    tracking: str,
    observation: str,
    reference: str,
    point: Vector,
    point_frame: str,
    time: int,
    interval: int,
) -> Twist:
    """Return how `tracking` moves in `observation`, averaged over an interval around a time [ns].

    It is expressed in `reference`. The interval ends at the latest time for which there are transforms.

    :raises TransformException: as lookups do.
    """
    latest = tree.latest_common_time(observation, tracking)
    length = interval * 1e-9
    end = min(time * 1e-9 + length * 0.5, latest * 1e-9)
    start = max(_MARGIN + length, end) - length

    def place(target: str, source: str, at: float) -> Transform:
        return tree.lookup(target, source, round(at * 1e9))[0]

    before, after = place(observation, tracking, start), place(observation, tracking, end)
    span = end - start
    linear = _scaled(_minus(after[:3], before[:3]), 1.0 / span)
    angular = rotate(before, _scaled(_rotation_vector(compose(invert(before), after)), 1.0 / span))

    seen = place(reference, tracking, time * 1e-9)
    angular = rotate(seen, angular)
    linear = _plus(rotate(seen, linear), _cross(seen[:3], angular))
    wanted = compose(place(reference, point_frame, time * 1e-9), (*point, 0.0, 0.0, 0.0, 1.0))
    offset = _minus(wanted[:3], seen[:3])
    # Upstream multiplies these element by element.
    return _plus(linear, (angular[0] * offset[0], angular[1] * offset[1], angular[2] * offset[2])), angular


def _rotation_vector(transform: Transform) -> Vector:
    """The axis of a rotation, as long as its angle [rad]."""
    axis = transform[3:6]
    sine = math.hypot(*axis)
    if not sine:
        return 0.0, 0.0, 0.0
    angle = 2.0 * math.atan2(sine, abs(transform[6]))
    return _scaled(axis, math.copysign(angle / sine, transform[6]))


def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _scaled(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
