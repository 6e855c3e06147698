"""The status array of an action, action_msgs/msg/GoalStatusArray, as it goes over the wire.

A server publishes the states of all goals that it knows whenever one changes, and a client looks for the few
that are its own. So servers put the array together from ready-made entries, and clients read no more of it
than ids and states: message objects would make each goal dearer by 1 us for every goal that is kept.
"""

from __future__ import annotations

from collections.abc import Collection
from struct import Struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rmw_local.message import MessageType

# An entry is the id, padding behind the single byte of the entry before, the stamp (s, ns), the state. The
# first one has no padding, since it follows the number of entries.
_ENTRY = Struct("<16s3xiIb")
_ID_AND_STATE = Struct("<16s3x8xb")
_LITTLE_ENDIAN = b"\0\1\0\0"
_FIRST = 8  # where the first entry begins
_ID = 16  # bytes
_PADDING = bytes(3)


def entry(uuid: bytes, accepted_ns: int, state: int) -> bytes:
    """The part of a status array that tells of one goal."""
    return _ENTRY.pack(uuid, *divmod(accepted_ns, 1_000_000_000), state)


def status_array(entries: Collection[bytes]) -> bytes:
    """The serialised message."""
    goals = b"".join(entries)
    number = len(entries).to_bytes(4, "little")
    return b"".join((_LITTLE_ENDIAN, number, goals[:_ID], goals[_ID + len(_PADDING) :]))


def states(data: bytes, message_type: MessageType) -> dict[bytes, int]:
    """The state of each goal, by its id; raises DecodeError if the bytes are no status array."""
    number = int.from_bytes(data[len(_LITTLE_ENDIAN) : _FIRST], "little")
    size = number * _ENTRY.size
    behind_id = _FIRST + _ID
    goals = b"".join((data[_FIRST:behind_id], _PADDING, data[behind_id : _FIRST + size - len(_PADDING)]))
    if data.startswith(_LITTLE_ENDIAN) and len(goals) == size:
        return dict(_ID_AND_STATE.iter_unpack(goals))
    reports = message_type.deserialize(data).status_list  # no goals, big endian, or malformed
    return {bytes(report.goal_info.goal_id.uuid): report.status for report in reports}
