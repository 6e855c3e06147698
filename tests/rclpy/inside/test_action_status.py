"""Status arrays that are written and read without message objects, compared with the messages themselves."""

from __future__ import annotations

import struct

import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from builtin_interfaces.msg import Time
from hypothesis import example, given
from hypothesis import strategies as st
from ifgen_runtime import serialize
from rclpy.impl.rcl.action_entity import StatusArray, states
from rmw_local.message import DecodeError, message_type
from unique_identifier_msgs.msg import UUID

KIND = message_type(GoalStatusArray)
UUIDS = st.binary(min_size=16, max_size=16) | st.lists(
    st.sampled_from(b"\0\1"), min_size=16, max_size=16
).map(bytes)
GOAL = st.tuples(UUIDS, st.integers(0, 2**31 * 10**9 - 1), st.integers(0, 6))


def message(goals: list[tuple[bytes, int, int]]) -> GoalStatusArray:
    reports = []
    for uuid, accepted_ns, state in goals:
        seconds, nanoseconds = divmod(accepted_ns, 10**9)
        stamp = Time(sec=seconds, nanosec=nanoseconds)
        info = GoalInfo(goal_id=UUID(uuid=list(uuid)), stamp=stamp)
        reports.append(GoalStatus(goal_info=info, status=state))
    return GoalStatusArray(status_list=reports)


@given(st.data())
def test_the_bytes_are_those_of_the_message(data: st.DataObject) -> None:
    """The bytes are the same whatever happens to goals, in any order."""
    array = StatusArray()
    goals: dict[bytes, tuple[int, int]] = {}
    assert array.to_bytes() == serialize(message([]))
    for _ in range(data.draw(st.integers(0, 12))):
        uuid, accepted_ns, state = data.draw(GOAL)
        known = data.draw(st.sampled_from(list(goals))) if goals else None
        match data.draw(st.sampled_from(["add", "add", "change", "remove", "remove first"])):
            case "add" if uuid not in goals:
                goals[uuid] = accepted_ns, state
                array.add(uuid, accepted_ns, state)
            case "change" if known is not None:
                goals[known] = goals[known][0], state
                array.change(known, state)
            case "remove" | "remove first" as which if known is not None:
                gone = known if which == "remove" else next(iter(goals))
                del goals[gone]
                array.remove(gone)
        expected = serialize(message([(uuid, *rest) for uuid, rest in goals.items()]))
        assert array.to_bytes() == expected


@pytest.mark.slow
@given(st.lists(GOAL, max_size=20), st.data())
@example([(bytes(16), 0, 1), (bytes(16), 0, 2), (b"\1" + bytes(15), 0, 3)], None)
def test_no_bytes_do_harm(goals: list[tuple[bytes, int, int]], data: st.DataObject | None) -> None:
    """Any bytes are read or refused just as the message would be."""
    garbled = bytearray(serialize(message(goals)))
    own = [uuid for uuid, _, _ in goals]
    if data is not None:
        for _ in range(data.draw(st.integers(0, 3))):
            garbled[data.draw(st.integers(0, len(garbled) - 1))] = data.draw(st.integers(0, 255))
        del garbled[data.draw(st.integers(0, len(garbled))) :]
        garbled += data.draw(st.binary(max_size=40))
        own = [bytes(16), *data.draw(st.sets(st.sampled_from(own)) if own else st.just(set()))]
    received = bytes(garbled)
    try:
        reports = KIND.deserialize(received).status_list
    except DecodeError:
        with pytest.raises(DecodeError):
            states(received, own, KIND)
    else:
        every = {bytes(report.goal_info.goal_id.uuid): report.status for report in reports}
        assert states(received, own, KIND) == {uuid: every[uuid] for uuid in own if uuid in every}


def test_big_endian_is_read() -> None:
    uuid = bytes(range(16))
    data = b"\0\0\0\0" + struct.pack(">I16siIb", 1, uuid, 7, 8, 4)
    assert states(data, [uuid], KIND) == {uuid: 4}
