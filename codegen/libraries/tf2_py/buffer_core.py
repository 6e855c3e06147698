"""`BufferCore`: a tree of frames that move, the transforms between any two at any time, and reports of it."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, TypeAlias

from rclpy.time import Time

from tf2_py import messages
from tf2_py.caches import Cache, seconds
from tf2_py.messages import complaint, require, to_message, to_nanoseconds
from tf2_py.transforms import Vector, compose, normalized
from tf2_py.tree import FrameTree, Twist, twist_between, without_detour

# What a rate is worked out with if all transforms are of one time [ns].
_SHORTEST_SPAN = 100_000


def as_yaml(tree: FrameTree) -> str:
    """Return each frame with its parent, who sends it, and how often: a document in YAML."""
    if not tree.frames:
        return "[]"
    parts: list[str] = []
    for name, cache in tree.frames.items():
        edge = None if cache is None else cache.newest_edge
        if cache is None or edge is None:
            continue
        parts.append(
            f"{name}: \n"
            f"  parent: '{edge[0]}'\n"
            f"  broadcaster: '{_authority(tree, name)}'\n"
            f"  rate: {_rate(cache):.3f}\n"
            f"  most_recent_transform: {seconds(cache.latest)}\n"
            f"  oldest_transform: {seconds(cache.oldest)}\n"
            f"  buffer_length: {_span(cache):.3f}\n"
        )
    return "".join(parts)


def as_dot(tree: FrameTree, now: int) -> str:
    """Return the tree as a graph of Graphviz, with ages if the time `now` [ns] is not 0."""
    lines = ["digraph G {\n"]
    if not tree.frames:
        lines.append('"no tf data recieved"')
    for name, cache in tree.frames.items():
        edge = None if cache is None else cache.newest_edge
        if cache is None or edge is None:
            continue
        age = f"( {(now - cache.latest) * 1e-9:.3f} sec old)" if now else ""
        lines.append(
            f'"{edge[0]}" -> "{name}"[label="Broadcaster: {_authority(tree, name)}\\n'
            f"Average rate: {_rate(cache):.3f} Hz\\n"
            f"Most recent transform: {seconds(cache.latest)} {age}\\n"
            f'Buffer length: {_span(cache):.3f} sec\\n"];\n'
        )
    recorded = f'"Recorded at time: {seconds(now)}"[ shape=plaintext ] ;\n ' if now else ""
    for name, cache in tree.frames.items():
        is_root = cache is None and now != 0
        if is_root or (cache is not None and cache.newest_edge is None):
            lines.append(
                "edge [style=invis];\n"
                ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
                f'{recorded}}}->"{name}";\n'
            )
    return "".join([*lines, "}"])


def _authority(tree: FrameTree, name: str) -> str:
    return tree.authorities.get(name, "no recorded authority")


def _rate(cache: Cache) -> float:
    """Transforms per second."""
    return len(cache) * 1e9 / max(cache.latest - cache.oldest, _SHORTEST_SPAN)


def _span(cache: Cache) -> float:
    """The time from the oldest to the latest, in seconds."""
    return (cache.latest - cache.oldest) * 1e-9


if TYPE_CHECKING:
    import builtin_interfaces.msg
    from geometry_msgs.msg import TransformStamped
    from rclpy.duration import Duration

    TimeLike: TypeAlias = Time | builtin_interfaces.msg.Time
    DurationLike: TypeAlias = Duration | builtin_interfaces.msg.Duration

DEFAULT_CACHE_TIME = 10 * messages.NANOSECONDS


class BufferCore:
    """Stores transforms, and looks them up. All threads may use it at once.

    A transform takes coordinates in its `child_frame_id` to coordinates in its `header.frame_id`. A frame has
    one parent at a time. A time of zero asks for the latest.

    :param cache_time: how long before its latest transform a frame's others are kept; 10 s if None.
    """

    def __init__(self, cache_time: DurationLike | None = None) -> None:
        limit = DEFAULT_CACHE_TIME if cache_time is None else to_nanoseconds(cache_time, "duration")
        self._tree = FrameTree(limit)
        self._lock = threading.RLock()

    def set_transform(self, transform: TransformStamped, authority: str, /) -> None:
        """Store a transform; one that makes no sense, or is too old, is logged and ignored.

        :param authority: who says so, for the log and the reports.
        """
        self._store(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str, /) -> None:
        """Store a transform that holds at all times."""
        self._store(transform, authority, is_static=True)

    def _store(self, message: TransformStamped, authority: str, *, is_static: bool) -> None:
        checked = messages.checked_transform(message, authority)
        if checked is None:
            return
        child, parent, transform = checked
        stamp = to_nanoseconds(message.header.stamp)
        with self._lock:
            stored = self._tree.insert(child, (parent, transform), stamp, is_static=is_static)
            if stored:
                self._tree.authorities[child] = authority
        if not stored:
            messages.report_old(child, seconds(stamp), authority)

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: TimeLike) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame.

        :raises LookupException: if a frame is not known.
        :raises ConnectivityException: if the frames are in different trees.
        :raises ExtrapolationException: if the time is before or after what is stored.
        :raises InvalidArgumentException: if no frame can have such a name.
        """
        stamp = to_nanoseconds(time)
        with self._lock:
            if target_frame != source_frame:
                self._require(target_frame=target_frame, source_frame=source_frame)
            transform, found = self._tree.lookup(target_frame, source_frame, stamp)
        return to_message(target_frame, source_frame, transform, found)

    def lookup_transform_full_core(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
    ) -> TransformStamped:
        """Return the transform between two frames at two times; the fixed frame does not move in between."""
        then, now = to_nanoseconds(source_time), to_nanoseconds(target_time)
        with self._lock:
            self._require(target_frame=target_frame, source_frame=source_frame, fixed_frame=fixed_frame)
            first, _ = self._tree.lookup(fixed_frame, source_frame, then)
            second, found = self._tree.lookup(target_frame, fixed_frame, now)
        both = compose(second, first)
        return to_message(target_frame, source_frame, normalized(both) or both, found)

    def can_transform_core(self, target_frame: str, source_frame: str, time: TimeLike) -> tuple[bool, str]:
        """Return whether there is a transform; if not, why."""
        stamp = to_nanoseconds(time)
        with self._lock:
            if target_frame == source_frame:
                return True, ""
            wrong = complaint(self._tree.frames, target_frame=target_frame, source_frame=source_frame)
            wrong = wrong or self._tree.why_not(target_frame, source_frame, stamp)
        return not wrong, wrong

    def can_transform_full_core(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
    ) -> tuple[bool, str]:
        """Return whether there is a transform between two frames at two times; if not, why."""
        then, now = to_nanoseconds(source_time), to_nanoseconds(target_time)
        with self._lock:
            wrong = complaint(
                self._tree.frames,
                target_frame=target_frame,
                source_frame=source_frame,
                fixed_frame=fixed_frame,
            )
            wrong = wrong or self._tree.why_not(target_frame, fixed_frame, now)
            wrong = wrong or self._tree.why_not(fixed_frame, source_frame, then)
        return not wrong, wrong

    def get_latest_common_time(self, target_frame: str, source_frame: str, /) -> Time:
        """Return the latest time for which there is a transform between two frames; 0 if all are static.

        :raises TransformException: if there is none.
        """
        with self._lock:
            for frame in (target_frame, source_frame):
                require(frame, self._tree.frames, "get_latest_common_time")
            return Time(nanoseconds=self._tree.latest_common_time(target_frame, source_frame))

    def lookupVelocityCore(
        self, tracking_frame: str, observation_frame: str, time: TimeLike, averaging_interval: DurationLike
    ) -> Twist:
        """Return how a frame moves in another: linear [m/s] and angular [rad/s]."""
        return self.lookupVelocityFullCore(
            tracking_frame, observation_frame, observation_frame, (0.0, 0.0, 0.0), tracking_frame, time,
            averaging_interval,
        )  # fmt: skip

    def lookupVelocityFullCore(
        self,
        tracking_frame: str,
        observation_frame: str,
        reference_frame: str,
        reference_point: Vector,
        reference_point_frame: str,
        time: TimeLike,
        averaging_interval: DurationLike,
        /,
    ) -> Twist:
        """Return how a frame moves in another, expressed in a third one, for a point in a fourth."""
        interval = to_nanoseconds(averaging_interval, "duration")
        with self._lock:
            self._require(target_frame=observation_frame, source_frame=tracking_frame)
            self._require(target_frame=reference_frame, source_frame=reference_point_frame)
            return twist_between(
                self._tree, tracking_frame, observation_frame, reference_frame, reference_point,
                reference_point_frame, to_nanoseconds(time), interval,
            )  # fmt: skip

    def clear(self) -> None:
        """Forget all transforms that are not static."""
        with self._lock:
            self._tree.clear()

    def all_frames_as_yaml(self) -> str:
        """Return each frame with its parent, who sends it, and how often: a document in YAML."""
        with self._lock:
            return as_yaml(self._tree)

    def all_frames_as_string(self) -> str:
        """Return a line for each frame that has had a parent."""
        with self._lock:
            return self._tree.as_string()

    def _allFramesAsDot(self, time: TimeLike | None = None) -> str:
        with self._lock:
            return as_dot(self._tree, 0 if time is None else to_nanoseconds(time))

    def _frameExists(self, frame_id: str, /) -> bool:
        with self._lock:
            return frame_id in self._tree.frames

    def _getFrameStrings(self) -> list[str]:
        with self._lock:
            return list(self._tree.frames)

    def _chain(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
    ) -> list[str]:
        """Return the names of the frames on the way from the source to the target."""
        then, now = to_nanoseconds(source_time), to_nanoseconds(target_time)
        with self._lock:
            self._require(target_frame=target_frame, source_frame=source_frame, fixed_frame=fixed_frame)
            there = self._tree.chain(fixed_frame, source_frame, then)
            back = self._tree.chain(fixed_frame, target_frame, now)
        return without_detour(there, back)

    def _require(self, **frames: str) -> None:
        for argument, frame in frames.items():
            require(frame, self._tree.frames, f"lookupTransform argument {argument}")
