"""BufferCore: which transforms are stored, and for how long."""

from __future__ import annotations

import math
import threading
import tracemalloc
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.duration import Duration
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
)

from tests.libraries.inside.tf2.frames import LATEST, at, buffer_of, edge, refused, x_of


def test_leading_slashes_are_dropped_from_what_is_set() -> None:
    assert x_of(buffer_of(edge("/map", "/base", x=0.1)), "map", "base") == 0.1


@pytest.mark.parametrize(
    "message",
    [
        edge("map", "map"),
        edge("/map", "map"),
        edge("", "base"),
        edge("map", ""),
        edge("map", "base", x=math.nan),
        edge("map", "base", rotation=(0.0, 0.0, 0.0, 0.0)),
        edge("map", "base", rotation=(0.0, math.nan, 0.0, 1.0)),
        edge("map", "base", rotation=(0.0, math.inf, 0.0, 1.0)),
        edge("map", "base", rotation=(1e-200, 0.0, 0.0, 0.0)),
        edge("map", "base", rotation=(0.0, 0.0, 1e200, 0.0)),
        TransformStamped(),
    ],
    ids=lambda message: f"{message.header.frame_id} {message.child_frame_id} {message.transform}"[-80:],
)
def test_what_makes_no_sense_is_ignored(message: TransformStamped) -> None:
    buffer = BufferCore()
    buffer.set_transform(message, "test")
    buffer.set_transform_static(message, "test")
    assert buffer._getFrameStrings() == []
    assert buffer.all_frames_as_yaml() == "[]"


def test_rotations_are_normalised_and_their_sign_is_chosen() -> None:
    def stored(*rotation: float) -> Any:
        buffer = buffer_of(edge("map", "base", rotation=rotation))  # type: ignore[arg-type]
        found = buffer.lookup_transform_core("map", "base", LATEST).transform.rotation
        return found.x, found.y, found.z, found.w

    assert stored(0.0, 0.0, 0.0, 2.0) == (0.0, 0.0, 0.0, 1.0)
    assert stored(0.0, 0.0, 0.0, -1.0) == (0.0, 0.0, 0.0, 1.0)
    assert stored(0.0, -1.0, 0.0, 0.0) == (0.0, 1.0, 0.0, 0.0)
    assert stored(0.6, 0.0, 0.0, -0.8) == pytest.approx((-0.6, 0.0, 0.0, 0.8))
    assert stored(0.9, 0.0, 0.1, -0.1)[0] > 0.0


def test_a_frame_can_get_another_parent() -> None:
    buffer = buffer_of(edge("map", "odom"), edge("map", "base", 1.0, x=5.0), edge("odom", "base", 2.0, x=0.1))
    assert x_of(buffer, "odom", "base", at(2.0)) == 0.1
    assert x_of(buffer, "map", "base", at(1.0)) == 5.0
    assert x_of(buffer, "map", "base", at(1.9)) == 5.0  # in between, that of the older one: nothing is mixed


def test_static_transforms_hold_at_all_times_and_survive_clear() -> None:
    buffer = buffer_of(edge("map", "base", 1.0), edge("map", "base", 2.0))
    buffer.set_transform_static(edge("base", "laser", 1.0, x=0.1), "test")
    assert x_of(buffer, "base", "laser", at(1e9)) == 0.1
    assert buffer.lookup_transform_core("base", "laser", LATEST).header.stamp == LATEST.to_msg()
    assert buffer.lookup_transform_core("map", "laser", LATEST).header.stamp == at(2.0).to_msg()
    assert buffer.get_latest_common_time("laser", "base") == LATEST
    buffer.set_transform_static(edge("base", "laser", 1.0, x=0.2), "test")
    buffer.clear()
    assert x_of(buffer, "base", "laser", at(0.1)) == 0.2
    assert refused(ConnectivityException, buffer, "map", "base", LATEST)
    assert refused(ExtrapolationException, buffer, "map", "base", at(1.5)).startswith(", when looking up")
    assert buffer._getFrameStrings() == ["base", "map", "laser"]


def test_the_last_kind_of_a_frame_counts() -> None:
    buffer = buffer_of(edge("map", "base", 1.0))
    buffer.set_transform_static(edge("map", "base", x=0.1), "test")
    assert x_of(buffer, "map", "base", at(99.0)) == 0.1
    buffer.set_transform(edge("map", "base", 2.0, x=0.2), "test")
    assert x_of(buffer, "map", "base") == 0.2
    assert refused(ExtrapolationException, buffer, "map", "base", at(1.0)).startswith("Lookup would require")


@pytest.mark.parametrize(("options", "kept"), [({}, 10), ({"cache_time": Duration(seconds=2.5)}, 2.5)])
def test_what_is_older_than_the_cache_time_is_dropped(options: dict[str, Any], kept: float) -> None:
    buffer = buffer_of(*(edge("map", "base", 100 + step * 0.5) for step in range(100)), **options)
    newest = 100 + 99 * 0.5
    # The next transform drops what is too old, as upstream.
    assert x_of(buffer, "map", "base", at(newest - kept - 0.5)) == 1.0
    assert refused(ExtrapolationException, buffer, "map", "base", at(newest - kept - 0.6))
    buffer.set_transform(edge("map", "base", newest - kept - 0.1, x=9.0), "test")
    assert refused(ExtrapolationException, buffer, "map", "base", at(newest - kept - 0.1))
    buffer.set_transform(edge("map", "base", newest - kept + 0.1, x=9.0), "test")
    assert x_of(buffer, "map", "base", at(newest - kept + 0.1)) == 9.0


def test_transforms_may_arrive_in_any_order() -> None:
    buffer = buffer_of(*(edge("map", "base", stamp, x=stamp) for stamp in (3.0, 1.0, 2.0, 1.5, 2.0, 3.0)))
    for tenth in range(10, 31):
        assert x_of(buffer, "map", "base", at(tenth / 10)) == pytest.approx(tenth / 10)
    assert x_of(buffer, "map", "base") == 3.0
    buffer.set_transform(edge("map", "base", 2.0, x=8.0), "test")
    assert x_of(buffer, "map", "base", at(2.0)) == 8.0  # the last one of a time counts
    assert "rate: 2.500" in buffer.all_frames_as_yaml()  # repeated ones do not


def test_memory_is_bounded_by_the_cache_time() -> None:
    buffer = BufferCore()
    message = edge("map", "base")

    def send(first: int) -> int:
        for tick in range(first, first + 30_000):  # 1 kHz
            message.header.stamp.sec, millisecond = divmod(tick, 1000)
            message.header.stamp.nanosec = millisecond * 1_000_000
            message.transform.translation.x = tick * 0.1
            buffer.set_transform(message, "test")
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        assert send(30_000) * 1.1 > send(60_000)
    finally:
        tracemalloc.stop()


def test_many_threads_at_once() -> None:
    """Both halves of a path are of one time, whoever writes in between."""
    buffer = buffer_of(edge("map", "odom", x=0.0), edge("odom", "base", x=0.0))
    errors: list[BaseException] = []
    done = threading.Event()

    def write() -> None:
        for tick in range(1, 3000):
            for parent, child, x in (("map", "odom", tick * 0.1), ("odom", "base", tick * -0.1)):
                buffer.set_transform(edge(parent, child, 1 + tick * 0.01, x=x), "test")

    def read() -> None:
        try:
            while not done.is_set():
                assert abs(x_of(buffer, "map", "base")) < 1e-9
                buffer.all_frames_as_yaml()
        except BaseException as error:
            errors.append(error)

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    try:
        write()
    finally:
        done.set()
        for reader in readers:
            reader.join()
    assert errors == []


IGNORING = 'Ignoring transform for child_frame_id "base" from authority "test" because of'


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            edge("base", "base"),
            'TF_SELF_TRANSFORM: Ignoring transform from authority "test" with frame_id and  child_frame_id "base" '
            "because they are the same",
        ),
        (
            edge("map", "/"),
            'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "test" because child_frame_id not set ',
        ),
        (
            edge("", "base"),
            'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "base"  from authority "test" because frame_id '
            "not set",
        ),
        (
            edge("map", "base", x=math.nan),
            f"TF_NAN_INPUT: {IGNORING} a nan value in the transform (nan 0.000000 0.000000) "
            "(0.000000 0.000000 0.000000 1.000000)",
        ),
        (
            edge("map", "base", rotation=(0.0, 0.0, 0.0, 0.0)),
            f"TF_DENORMALIZED_QUATERNION: {IGNORING} an invalid quaternion in the transform "
            "(0.000000 0.000000 0.000000 0.000000)",
        ),
        (
            edge("map", "base", 80.5),
            "TF_OLD_DATA ignoring data from the past for frame base at time 80.500000 according to authority test\n"
            "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
        ),
    ],
    ids=["self", "child", "parent", "nan", "quaternion", "old"],
)
def test_the_log_says_what_is_ignored(message: TransformStamped, said: str, capfd: Any) -> None:
    buffer = buffer_of(edge("map", "base", 100.0))
    capfd.readouterr()
    buffer.set_transform(message, "test")
    logged = capfd.readouterr().err
    assert f"[tf2]: {said}\n" in logged
    assert logged.count("TF_") == 1


def test_infinite_distances_are_stored() -> None:
    assert x_of(buffer_of(edge("map", "base", x=math.inf)), "map", "base") == math.inf
    two = edge("map", "base", x=math.inf)
    two.transform.translation.y = -math.inf  # their sum is not a number
    assert x_of(buffer_of(two), "map", "base") == math.inf


class Model:
    """What a frame's cache keeps and returns, said as slowly as possible."""

    def __init__(self) -> None:
        self.stored: list[tuple[int, str, float]] = []  # time, parent and x, as they came

    def insert(self, entry: tuple[int, str, float]) -> None:
        oldest = max((time for time, _, _ in self.stored), default=0) - 100
        self.stored = [kept for kept in self.stored if kept[0] >= oldest]
        if (not self.stored or entry[0] >= oldest) and entry not in self.stored:
            self.stored.append(entry)

    def at(self, time: int) -> tuple[str, float] | None:
        times = {entry[0] for entry in self.stored}
        exact = [entry[1:] for entry in self.stored if entry[0] == time]
        if exact:
            return exact[0] if time == min(times) != max(times) else exact[-1]
        if not times or not min(times) < time < max(times):
            return None
        since, until = max(t for t in times if t < time), min(t for t in times if t > time)
        parent, x = [entry[1:] for entry in self.stored if entry[0] == since][-1]
        next_parent, next_x = next(entry[1:] for entry in self.stored if entry[0] == until)
        ratio = (time - since) / (until - since) if next_parent == parent else 0.0
        return parent, x + ratio * (next_x - x)


@given(
    st.lists(
        st.tuples(st.integers(1, 160), st.sampled_from(["map", "odom"]), st.sampled_from([0.1, 0.2, 0.7])),
        min_size=1,
        max_size=25,
    )
)
@settings(max_examples=60)
def test_all_orders_of_arrival(entries: list[tuple[int, str, float]]) -> None:
    """Times are in tenths of a second, so that the cache time is 100."""
    model, buffer = Model(), BufferCore()
    for entry in entries:
        model.insert(entry)
        buffer.set_transform(edge(entry[1], "base", entry[0] / 10, x=entry[2]), "test")
    for time in sorted({near for entry in entries for near in (entry[0] - 1, entry[0], entry[0] + 1)} - {0}):
        expected = model.at(time)
        for parent in ("map", "odom"):
            possible, _ = buffer.can_transform_core(parent, "base", at(time / 10))
            assert possible == (expected is not None and expected[0] == parent)
            if possible and expected is not None:
                assert x_of(buffer, parent, "base", at(time / 10)) == pytest.approx(expected[1])
