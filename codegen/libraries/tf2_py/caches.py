"""The transforms of one frame to its parent, by time."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import TypeAlias

from tf2_py.transforms import Transform, interpolate

# The parent, and the transform to it.
Edge: TypeAlias = tuple[str, Transform]


def seconds(stamp: int) -> str:
    """A time in nanoseconds, as texts show it."""
    return f"{stamp // 10**9 + stamp % 10**9 * 1e-9:.6f}"


class TimeCache:
    """The transforms of a frame that moves. Times are in nanoseconds; 0 asks for the latest.

    :param limit: how long before the latest transform others are kept, in nanoseconds.
    """

    __slots__ = ("_edges", "_limit", "_stamps")
    is_static = False

    def __init__(self, limit: int) -> None:
        self._limit = limit
        # In the order of time; of one time, in the order of arrival.
        self._stamps: list[int] = []
        self._edges: list[Edge] = []

    def __len__(self) -> int:
        return len(self._stamps)

    @property
    def latest(self) -> int:
        """The time of the latest transform; 0 if there is none."""
        return self._stamps[-1] if self._stamps else 0

    @property
    def oldest(self) -> int:
        """The time of the oldest transform; 0 if there is none."""
        return self._stamps[0] if self._stamps else 0

    @property
    def newest_edge(self) -> Edge | None:
        """The latest transform, and the parent."""
        return self._edges[-1] if self._edges else None

    def at(self, stamp: int) -> Edge | None:
        """Return the transform at a time, interpolated; None outside of what is stored."""
        stamps = self._stamps
        if not stamps:
            return None
        last = stamps[-1]
        if stamp == last or not stamp:
            return self._edges[-1]
        if stamp > last or stamp <= stamps[0]:
            return self._edges[0] if stamp == stamps[0] else None
        index = bisect_right(stamps, stamp)
        since = stamps[index - 1]
        older, newer = self._edges[index - 1], self._edges[index]
        if since == stamp or older[0] != newer[0]:  # the frame got another parent in between
            return older
        return (older[0], interpolate(older[1], newer[1], (stamp - since) / (stamps[index] - since)))

    def why_not(self, stamp: int) -> str:
        """Say why `at` returns None."""
        if not self._stamps:
            return ""
        if len(self._stamps) == 1:
            return (
                f"Lookup would require extrapolation at time {seconds(stamp)}, "
                f"but only time {seconds(self.latest)} is in the buffer"
            )
        where, end, limit = ("future", "latest", self.latest)
        if stamp < self.oldest:
            where, end, limit = ("past", "earliest", self.oldest)
        return (
            f"Lookup would require extrapolation into the {where}.  Requested time {seconds(stamp)} "
            f"but the {end} data is at time {seconds(limit)}"
        )

    def insert(self, stamp: int, edge: Edge) -> bool:
        """Store a transform, unless it is older than others are kept; return whether it is stored."""
        stamps, edges = self._stamps, self._edges
        if not stamps:
            stamps.append(stamp)
            edges.append(edge)
            return True
        last = stamps[-1]
        # Before the new one counts, as upstream: two transforms that are further apart can be interpolated.
        oldest = last - self._limit
        if stamps[0] < oldest:
            expired = bisect_left(stamps, oldest)
            del stamps[:expired], edges[:expired]
        if stamp < oldest:
            return False
        if stamp > last:
            stamps.append(stamp)
            edges.append(edge)
            return True
        index = bisect_right(stamps, stamp)
        if edge not in edges[bisect_left(stamps, stamp) : index]:  # repeated messages are kept once
            stamps.insert(index, stamp)
            edges.insert(index, edge)
        return True

    def clear(self) -> None:
        """Forget all."""
        self._stamps.clear()
        self._edges.clear()


class StaticCache:
    """The one transform of a frame that does not move, which holds at all times."""

    __slots__ = ("_edge",)
    is_static = True
    latest = oldest = 0

    def __init__(self) -> None:
        self._edge: Edge | None = None

    def __len__(self) -> int:
        return 1

    @property
    def newest_edge(self) -> Edge | None:
        """The transform, and the parent."""
        return self._edge

    def at(self, stamp: int) -> Edge | None:
        """Return the transform, whatever the time."""
        return self._edge

    def why_not(self, stamp: int) -> str:
        """Return nothing: it is always there."""
        return ""

    def insert(self, stamp: int, edge: Edge) -> bool:
        """Store a transform in place of the one before."""
        self._edge = edge
        return True

    def clear(self) -> None:
        """Keep it: nobody sends it again."""


Cache: TypeAlias = TimeCache | StaticCache
