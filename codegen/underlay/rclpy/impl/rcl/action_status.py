"""The status array of an action, action_msgs/msg/GoalStatusArray, as it goes over the wire.

A server publishes the states of all goals that it knows whenever one changes, and a client looks for the few
that are its own. So a server changes bytes in place, and a client searches them: message objects would make
each goal dearer by 1 us for every goal that is kept.
"""

from __future__ import annotations

from collections.abc import Collection
from struct import Struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rmw_local.message import MessageType

# An entry is the id, padding after the single byte of the entry before, the stamp (s, ns), the state. On the
# wire the first one has no padding, because it follows the number of entries.
_ENTRY = Struct("<16s3xiIb")
_SIZE = _ENTRY.size
_STATE = _SIZE - 1  # where in an entry
_ID = 16  # bytes
_PADDING = bytes(3)
_FIRST = 8  # where on the wire
_LITTLE_ENDIAN = b"\0\1\0\0"
_FEW = 8  # up to this number, searching for goals is faster than reading all entries


class StatusArray:
    """The status array of a server; goals are in order of acceptance."""

    def __init__(self) -> None:
        self._entries = bytearray()
        self._removed = 0  # bytes, at the front
        self._places: dict[bytes, int] = {}  # by id; counted from where the first entry ever was

    def add(self, uuid: bytes, accepted_ns: int, state: int) -> None:
        """Append a goal."""
        self._places[uuid] = self._removed + len(self._entries)
        self._entries += _ENTRY.pack(uuid, *divmod(accepted_ns, 1_000_000_000), state)

    def change(self, uuid: bytes, state: int) -> None:
        """Change a goal's state."""
        self._entries[self._places[uuid] - self._removed + _STATE] = state

    def remove(self, uuid: bytes) -> None:
        """Take a goal out; the first one takes no time."""
        place = self._places.pop(uuid)
        begin = place - self._removed
        del self._entries[begin : begin + _SIZE]
        if begin == 0:
            self._removed += _SIZE
        else:
            self._places = {other: at - _SIZE * (at > place) for other, at in self._places.items()}

    def to_bytes(self) -> bytes:
        """The serialised message."""
        entries = self._entries
        number = len(self._places).to_bytes(4, "little")
        return b"".join((_LITTLE_ENDIAN, number, entries[:_ID], entries[_ID + len(_PADDING) :]))


def states(data: bytes, goals: Collection[bytes], message_type: MessageType) -> dict[bytes, int]:
    """The states of these goals, by id, of those that are in a serialised status array.

    Raises DecodeError if the bytes are none.
    """
    size = int.from_bytes(data[len(_LITTLE_ENDIAN) : _FIRST], "little") * _SIZE
    behind_id = _FIRST + _ID
    entries = b"".join((data[_FIRST:behind_id], _PADDING, data[behind_id : _FIRST + size - len(_PADDING)]))
    if not data.startswith(_LITTLE_ENDIAN) or len(entries) != size:  # or there are no goals
        reports = message_type.deserialize(data).status_list
        known = {bytes(report.goal_info.goal_id.uuid): report.status for report in reports}
    elif len(goals) > _FEW:
        known = {uuid: state for uuid, _, _, state in _ENTRY.iter_unpack(entries)}
    else:
        places = ((goal, _place(entries, goal)) for goal in goals)
        return {goal: _ENTRY.unpack_from(entries, at)[-1] for goal, at in places if at >= 0}
    return {goal: known[goal] for goal in goals if goal in known}


def _place(entries: bytes, uuid: bytes) -> int:
    """The offset of the last entry of a goal, -1 if there is none; its bytes may be elsewhere as well."""
    at = entries.rfind(uuid)
    while at > 0 and at % _SIZE:
        at = entries.rfind(uuid, 0, at + _ID - 1)
    return at
