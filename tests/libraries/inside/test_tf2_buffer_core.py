"""BufferCore: the rules of the tree, what is kept, and what is said of what is not there."""

from __future__ import annotations

import math
import threading
import tracemalloc
from typing import Any

import pytest
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)

LATEST = Time()


def at(seconds: float) -> Time:
    return Time(nanoseconds=round(seconds * 1e9))


def edge(
    parent: str,
    child: str,
    stamp: float = 1.0,
    x: float = 1.0,
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0),
) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = at(stamp).to_msg()
    message.transform.translation = Vector3(x=x, y=0.0, z=0.0)
    message.transform.rotation = Quaternion(x=rotation[0], y=rotation[1], z=rotation[2], w=rotation[3])
    return message


def buffer_of(*edges: TransformStamped, **options: Any) -> BufferCore:
    buffer = BufferCore(**options)
    for message in edges:
        buffer.set_transform(message, "test")
    return buffer


def x_of(buffer: BufferCore, target: str, source: str, time: Any = LATEST) -> float:
    return buffer.lookup_transform_core(target, source, time).transform.translation.x


def refused(kind: type[TransformException], buffer: BufferCore, target: str, source: str, time: Any) -> str:
    """The text of the exception, which can_transform_core says as well."""
    with pytest.raises(TransformException) as caught:
        buffer.lookup_transform_core(target, source, time)
    assert type(caught.value) is kind
    possible, why = buffer.can_transform_core(target, source, time)
    assert not possible and why
    if kind in {ConnectivityException, ExtrapolationException}:
        assert why == str(caught.value)
    return str(caught.value)


def test_what_was_set_is_found() -> None:
    message = edge("map", "base", 1.1, x=0.1)
    buffer = buffer_of(message)
    assert buffer.set_transform(message, "test") is None  # type: ignore[func-returns-value]
    for time_ in (LATEST, at(1.1), at(1.1).to_msg()):
        assert buffer.lookup_transform_core("map", "base", time_) == message
    assert buffer.lookup_transform_core(target_frame="map", source_frame="base", time=LATEST) == message
    assert buffer.can_transform_core("base", "map", at(1.1)) == (True, "")
    assert x_of(buffer, "base", "map") == -0.1


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        # Frames with x of their origin in the root: the tree "a" with "b" and "c" in a line, and two branches.
        ([("a", "b"), ("b", "c")], {"a": 0, "b": 1, "c": 2}),
        ([("a", "b"), ("b", "c"), ("a", "f"), ("f", "g")], {"a": 0, "b": 1, "c": 2, "f": 1, "g": 2}),
        ([("r", "a"), ("a", "b"), ("r", "d"), ("d", "e"), ("e", "f")], {"r": 0, "b": 2, "f": 3}),
        ([("a", "1")], {"a": 0, "1": 1}),
    ],
)
@pytest.mark.parametrize("stamp", [0.0, 1.0, 10.0])
def test_all_ways_through_a_tree(shape: Any, expected: dict[str, int], stamp: float) -> None:
    buffer = buffer_of(*(edge(parent, child, stamp) for parent, child in shape))
    for target, origin in expected.items():
        for source, place in expected.items():
            found = buffer.lookup_transform_core(target, source, at(stamp))
            assert found.transform.translation.x == place - origin
            assert (found.header.frame_id, found.child_frame_id) == (target, source)
            assert found.header.stamp == at(stamp).to_msg()


def test_a_quarter_of_the_way() -> None:
    half_turn = (0.0, 0.0, 1.0, 0.0)
    buffer = buffer_of(edge("map", "base", 1.0, x=0.0), edge("map", "base", 2.0, x=0.4, rotation=half_turn))
    found = buffer.lookup_transform_core("map", "base", at(1.25))
    assert found.transform.translation.x == pytest.approx(0.1)
    assert found.transform.rotation.z == pytest.approx(math.sin(math.pi / 8))
    assert found.transform.rotation.w == pytest.approx(math.cos(math.pi / 8))


FUTURE = (
    "Lookup would require extrapolation into the future.  Requested time 2.500000 but the latest data is at time "
    "2.000000, when looking up transform from frame [base] to frame [map]"
)
PAST = (
    "Lookup would require extrapolation into the past.  Requested time 0.500000 but the earliest data is at time "
    "1.000000, when looking up transform from frame [base] to frame [map]"
)
ONLY = (
    "Lookup would require extrapolation at time 2.500000, but only time 1.000000 is in the buffer, when looking up "
    "transform from frame [base] to frame [map]"
)


def test_before_and_after_what_is_stored() -> None:
    buffer = buffer_of(edge("map", "base", 1.0))
    assert refused(ExtrapolationException, buffer, "map", "base", at(2.5)) == ONLY
    buffer.set_transform(edge("map", "base", 2.0), "test")
    assert refused(ExtrapolationException, buffer, "map", "base", at(2.5)) == FUTURE
    assert refused(ExtrapolationException, buffer, "map", "base", at(0.5)) == PAST
    back = FUTURE.replace("[base] to frame [map]", "[map] to frame [base]")
    assert refused(ExtrapolationException, buffer, "base", "map", at(2.5)) == back
    assert x_of(buffer, "map", "base", at(1.0)) == x_of(buffer, "map", "base", at(2.0)) == 1.0


def test_a_time_at_which_only_one_of_two_branches_is_known() -> None:
    buffer = buffer_of(
        edge("map", "a", 1.0), edge("map", "a", 2.0), edge("map", "b", 1.5), edge("map", "b", 3.0)
    )
    said = refused(ExtrapolationException, buffer, "a", "b", at(2.5))
    assert said.startswith("Lookup would require extrapolation into the future.  Requested time 2.500000 but")
    assert said.endswith("from frame [b] to frame [a]")
    assert refused(ExtrapolationException, buffer, "b", "a", at(2.5)).endswith("from frame [a] to frame [b]")
    assert buffer.lookup_transform_core("a", "b", LATEST).header.stamp == at(2.0).to_msg()
    assert buffer.get_latest_common_time("a", "b") == at(2.0)


def test_names_that_are_not_there() -> None:
    buffer = buffer_of(edge("map", "base"), edge("moon", "lander"))
    unknown = '"{}" passed to lookupTransform argument {} does not exist. '
    assert refused(LookupException, buffer, "map", "arm", LATEST) == unknown.format("arm", "source_frame")
    assert refused(LookupException, buffer, "arm", "map", LATEST) == unknown.format("arm", "target_frame")
    invalid = (
        'Invalid argument "{}" passed to lookupTransform argument source_frame - in tf2 frame_ids cannot '
    )
    assert refused(InvalidArgumentException, buffer, "map", "", LATEST) == invalid.format("") + "be empty"
    said = refused(InvalidArgumentException, buffer, "map", "/base", LATEST)
    assert said == invalid.format("/base") + "start with a '/'"
    assert refused(ConnectivityException, buffer, "map", "lander", LATEST) == (
        "Could not find a connection between 'map' and 'lander' because they are not part of the same tree."
        "Tf has two or more unconnected trees."
    )
    assert refused(ConnectivityException, buffer, "map", "lander", at(1.0)).startswith("Could not find")
    assert buffer.can_transform_core("map", "arm", LATEST) == (
        False,
        'Invalid frame ID "arm" passed to canTransform argument source_frame - frame does not exist',
    )
    with pytest.raises(TypeError, match="must be a str, got None"):
        buffer.lookup_transform_core(None, "map", LATEST)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="time must have sec and nanosec, or nanoseconds"):
        buffer.lookup_transform_core("map", "base", 1.0)  # type: ignore[arg-type]


def test_a_frame_to_itself() -> None:
    buffer = buffer_of(edge("map", "base", 1.5))
    for name in ("map", "base", "unknown"):
        found = buffer.lookup_transform_core(name, name, at(7.1))
        assert found.transform == TransformStamped().transform and found.header.stamp == at(7.1).to_msg()
        assert buffer.can_transform_core(name, name, at(7.1)) == (True, "")
    assert buffer.lookup_transform_core("base", "base", LATEST).header.stamp == at(1.5).to_msg()


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


@pytest.mark.parametrize("length", [2, 3, 50])
def test_a_loop_is_found(length: int) -> None:
    names = [f"f{index}" for index in range(length)]
    buffer = buffer_of(
        *(edge(parent, child) for parent, child in zip(names, [*names[1:], names[0]], strict=True)),
        edge("elsewhere", "lost"),
    )
    for time_ in (LATEST, at(1.0)):
        for target, source in (("f0", "lost"), ("lost", "f0")):
            said = refused_loop(buffer, target, source, time_)
            assert said.startswith("The tf tree is invalid because it contains a loop.\nFrame f1 exists with")


def refused_loop(buffer: BufferCore, target: str, source: str, time_: Any) -> str:
    with pytest.raises(LookupException) as caught:
        buffer.lookup_transform_core(target, source, time_)
    assert buffer.can_transform_core(target, source, time_) == (False, str(caught.value))
    return str(caught.value)


def test_deep_trees() -> None:
    buffer = buffer_of(*(edge(f"f{index}", f"f{index + 1}") for index in range(10_000)))
    assert x_of(buffer, "f0", "f1000") == 1000.0
    assert x_of(buffer, "f1000", "f0", at(1.0)) == -1000.0
    for time_ in (LATEST, at(1.0)):  # upstream takes more for a loop
        assert refused_loop(buffer, "f0", "f10000", time_).startswith("The tf tree is invalid")
        assert refused_loop(buffer, "f10000", "f0", time_).startswith("The tf tree is invalid")
    assert len(buffer.all_frames_as_string().splitlines()) == 10_000


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


def test_reports() -> None:
    buffer = buffer_of(edge("map", "base", 1.0), edge("map", "base", 2.5), edge("map", "base", 2.0))
    buffer.set_transform_static(edge("base", "laser"), "me")
    assert buffer.all_frames_as_string() == (
        "Frame base exists with parent map.\nFrame laser exists with parent base.\n"
    )
    assert buffer.all_frames_as_yaml() == (
        "base: \n  parent: 'map'\n  broadcaster: 'test'\n  rate: 2.000\n  most_recent_transform: 2.500000\n"
        "  oldest_transform: 1.000000\n  buffer_length: 1.500\n"
        "laser: \n  parent: 'base'\n  broadcaster: 'me'\n  rate: 10000.000\n  most_recent_transform: 0.000000\n"
        "  oldest_transform: 0.000000\n  buffer_length: 0.000\n"
    )
    dot = buffer._allFramesAsDot(at(3.0))
    assert dot.startswith(
        'digraph G {\n"map" -> "base"[label="Broadcaster: test\\nAverage rate: 2.000 Hz\\nMost recent transform: '
        '2.500000 ( 0.500 sec old)\\nBuffer length: 1.500 sec\\n"];\n'
    )
    assert dot.endswith('"Recorded at time: 3.000000"[ shape=plaintext ] ;\n }->"map";\n}')
    assert "sec old" not in buffer._allFramesAsDot()
    assert BufferCore()._allFramesAsDot() == 'digraph G {\n"no tf data recieved"}'
    assert buffer._frameExists("map") and not buffer._frameExists("/map")
    assert buffer._getFrameStrings() == ["base", "map", "laser"]


def test_chains() -> None:
    buffer = buffer_of(edge("A", "B"), edge("B", "C"), edge("A", "D"), edge("x", "y"))
    assert buffer._chain("D", at(1.0), "C", at(1.0), "A") == ["C", "B", "A", "D"]
    assert buffer._chain("C", LATEST, "D", LATEST, "B") == ["D", "A", "B", "C"]
    assert buffer._chain("B", LATEST, "C", LATEST, "A") == ["C", "B"]
    assert buffer._chain("C", LATEST, "A", LATEST, "A") == ["A", "B", "C"]
    with pytest.raises(LookupException):
        buffer._chain("D", at(1.0), "none", at(1.0), "A")
    with pytest.raises(ConnectivityException):
        buffer._chain("A", at(1.0), "y", at(1.0), "A")
    with pytest.raises(ExtrapolationException):
        buffer._chain("D", at(2.0), "C", at(2.0), "A")


def square(x: Any, buffer: BufferCore) -> None:
    """A frame that goes up and down in each axis, a second each way; `x` places it."""
    position = [0.0, 0.0, 0.0]
    buffer.set_transform(x(position, 100.0), "test")
    for step in range(60):
        second = step // 10
        position[second // 2] += 0.1 if second % 2 == 0 else -0.1
        buffer.set_transform(x(position, 100 + (step + 1) / 10), "test")
    buffer.set_transform_static(edge("foo", "beside", x=1.0), "test")


def test_linear_velocity() -> None:
    def place(position: list[float], stamp: float) -> TransformStamped:
        message = edge("foo", "bar", stamp)
        message.transform.translation = Vector3(x=position[0], y=position[1], z=position[2])
        return message

    buffer = BufferCore()
    square(place, buffer)
    for seconds, axis, sign in (
        (0.5, 0, 1),
        (1.5, 0, -1),
        (2.5, 1, 1),
        (3.5, 1, -1),
        (4.5, 2, 1),
        (5.5, 2, -1),
    ):
        for frame in ("foo", "beside"):
            linear, angular = buffer.lookupVelocityCore(
                "bar", frame, at(100 + seconds), Duration(seconds=0.1)
            )
            assert linear == pytest.approx([sign if index == axis else 0 for index in range(3)], abs=1e-6)
            assert angular == pytest.approx((0, 0, 0), abs=1e-6)


def test_angular_velocity() -> None:
    def place(position: list[float], stamp: float) -> TransformStamped:
        half = [value / 2 for value in position]
        rotation = (math.sin(half[0]), math.sin(half[1]), math.sin(half[2]), math.cos(sum(half)))
        return edge("foo", "bar", stamp, x=0.0, rotation=rotation)

    buffer = BufferCore()
    square(place, buffer)
    # Seen from 1 m beside it, what turns about y or z also moves.
    for seconds, angular, linear in (
        (0.5, (1, 0, 0), (0, 0, 0)),
        (1.5, (-1, 0, 0), (0, 0, 0)),
        (2.5, (0, 1, 0), (0, 0, -1)),
        (3.5, (0, -1, 0), (0, 0, 1)),
        (4.5, (0, 0, 1), (0, 1, 0)),
        (5.5, (0, 0, -1), (0, -1, 0)),
    ):
        interval = Duration(seconds=0.1)
        found = buffer.lookupVelocityCore("bar", "foo", at(100 + seconds), interval)
        assert found[0] == pytest.approx((0, 0, 0), abs=1e-6)
        assert found[1] == pytest.approx(angular, abs=1e-6)
        found = buffer.lookupVelocityCore("bar", "beside", at(100 + seconds), interval)
        assert found[0] == pytest.approx(linear, abs=1e-6)
        assert found[1] == pytest.approx(angular, abs=1e-6)


def test_velocity_of_all_that_is_stored() -> None:
    buffer = buffer_of(*(edge("PARENT", "THISFRAME", second, x=second * 3.0) for second in range(5)))
    interval = Duration(seconds=4, nanoseconds=1_000_000)
    simple = buffer.lookupVelocityCore("THISFRAME", "PARENT", LATEST, interval)
    assert simple[0][0] == pytest.approx(3.0, abs=0.01)
    full = buffer.lookupVelocityFullCore(
        "THISFRAME", "PARENT", "PARENT", (0, 0, 0), "THISFRAME", LATEST, interval
    )
    assert full == simple
    with pytest.raises(LookupException):
        buffer.lookupVelocityCore("none", "PARENT", LATEST, interval)


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
