"""BufferCore: what lookups return, and what they say of what is not there."""

from __future__ import annotations

import math
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from tf2_py import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
)

from tests.libraries.inside.tf2.frames import LATEST, at, buffer_of, edge, refused, x_of


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
    # What is above the frame where both ways meet does not count.
    buffer.set_transform(edge("earth", "map", 0.5), "test")
    assert buffer.get_latest_common_time("a", "b") == buffer.get_latest_common_time("b", "a") == at(2.0)
    assert buffer.get_latest_common_time("a", "earth") == at(0.5)


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
