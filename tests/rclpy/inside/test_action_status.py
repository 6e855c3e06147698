"""Status arrays put together and read without message objects, beside the messages themselves."""

from __future__ import annotations

import struct

import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from builtin_interfaces.msg import Time
from hypothesis import example, given
from hypothesis import strategies as st
from ifgen_runtime import serialize
from rclpy.impl.rcl.action_status import entry, states, status_array
from rmw_local.message import DecodeError, message_type
from unique_identifier_msgs.msg import UUID

KIND = message_type(GoalStatusArray)
GOALS = st.lists(
    st.tuples(st.binary(min_size=16, max_size=16), st.integers(0, 2**31 * 10**9 - 1), st.integers(0, 6))
)


def message(goals: list[tuple[bytes, int, int]]) -> GoalStatusArray:
    reports = []
    for uuid, accepted_ns, state in goals:
        seconds, nanoseconds = divmod(accepted_ns, 10**9)
        stamp = Time(sec=seconds, nanosec=nanoseconds)
        info = GoalInfo(goal_id=UUID(uuid=list(uuid)), stamp=stamp)
        reports.append(GoalStatus(goal_info=info, status=state))
    return GoalStatusArray(status_list=reports)


@given(GOALS)
@example([])
def test_they_are_the_bytes_of_the_message(goals: list[tuple[bytes, int, int]]) -> None:
    data = status_array([entry(*goal) for goal in goals])
    assert data == serialize(message(goals))
    assert states(data, KIND) == {uuid: state for uuid, _, state in goals}


@given(GOALS, st.data())
def test_no_bytes_do_harm(goals: list[tuple[bytes, int, int]], data: st.DataObject) -> None:
    """Whatever arrives is read, or refused, as the message is."""
    garbled = bytearray(serialize(message(goals)))
    for _ in range(data.draw(st.integers(0, 3))):
        garbled[data.draw(st.integers(0, len(garbled) - 1))] = data.draw(st.integers(0, 255))
    received = bytes(garbled[: data.draw(st.integers(0, len(garbled)))]) + data.draw(st.binary(max_size=40))
    try:
        reports = KIND.deserialize(received).status_list
    except DecodeError:
        with pytest.raises(DecodeError):
            states(received, KIND)
    else:
        expected = {bytes(report.goal_info.goal_id.uuid): report.status for report in reports}
        assert states(received, KIND) == expected


def test_big_endian_is_read() -> None:
    uuid = bytes(range(16))
    data = b"\0\0\0\0" + struct.pack(">I16siIb", 1, uuid, 7, 8, 4)
    assert states(data, KIND) == {uuid: 4}
