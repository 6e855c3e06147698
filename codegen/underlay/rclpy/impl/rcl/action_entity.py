"""The goals of an action server, and the common part of the handles of action clients and servers.

That part is several handles that count as one.
"""

from __future__ import annotations

from collections.abc import Collection
from struct import Struct
from typing import TYPE_CHECKING, Any

from rmw_local.message import message_type, service_type

from .clock import Clock, Timer
from .handle import Destroyable, RCLError
from .names import as_c_string, rclpy_get_validation_error_for_full_topic_name
from .service_introspection import ServiceIntrospectionState
from .services import Client, Service
from .structs import ExtensionEnum
from .topics import Publisher, Subscription

if TYPE_CHECKING:
    from rmw_local.message import MessageType

    from .action_server import ActionServer
    from .node import Node
    from .wait_set import WaitSet


# The values of action_msgs/msg/GoalStatus.
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
_STATE_NAMES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")


def key_of(goal_id: Any) -> bytes:
    """The bytes of an id, a unique_identifier_msgs/msg/UUID."""
    key: bytes = goal_id.uuid.tobytes()
    return key


class GoalEvent(ExtensionEnum):
    """Events of an accepted goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


_NEXT_STATE = {
    (ACCEPTED, GoalEvent.EXECUTE): EXECUTING,
    (ACCEPTED, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.SUCCEED): SUCCEEDED,
    (EXECUTING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.SUCCEED): SUCCEEDED,
    (CANCELING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.CANCELED): CANCELED,
}


class Goal:
    """A goal that a server knows, from acceptance until its result expires."""

    __slots__ = ("accepted_ns", "ended_ns", "state", "uuid")

    def __init__(self, uuid: bytes, accepted_ns: int) -> None:
        self.uuid = uuid
        self.accepted_ns = accepted_ns  # on the server's clock
        self.ended_ns = 0  # the same, once it is in a terminal state
        self.state = ACCEPTED  # a value of GoalStatus

    @property
    def is_active(self) -> bool:
        """Whether it is not in a terminal state."""
        return self.state in (ACCEPTED, EXECUTING, CANCELING)

    @property
    def is_cancelable(self) -> bool:
        """Whether a request to cancel it is allowed."""
        return (self.state, GoalEvent.CANCEL_GOAL) in _NEXT_STATE

    def advance(self, event: GoalEvent) -> None:
        """Change the state; raises RCLError if the event may not happen in it."""
        following = _NEXT_STATE.get((self.state, event))
        if following is None:
            raise RCLError(
                "Failed to update goal state: goal_handle attempted invalid transition "
                f"from state {_STATE_NAMES[self.state]} with event {event.name}"
            )
        self.state = following


class ActionGoalHandle(Destroyable):
    """A goal that a server accepts by the making of this handle, and forgets by its destruction.

    Raises RCLError if the server knows a goal of this id.
    """

    def __init__(self, action_server: ActionServer, pygoal_info: Any) -> None:
        super().__init__()
        self._server = action_server
        self._goal = action_server.accept(pygoal_info)

    def get_status(self) -> int:
        """Return the state as a value of GoalStatus."""
        if self._destroyed:
            raise RCLError("Failed to get goal status: goal handle pointer is invalid")
        return self._goal.state

    def is_active(self) -> bool:
        """Whether the goal is neither destroyed nor in a terminal state."""
        return not self._destroyed and self._goal.is_active

    def update_goal_state(self, event: object) -> None:
        """Change the state; raises RCLError if the event may not happen in the present one."""
        if self._destroyed:
            raise RCLError("Failed to update goal state: goal handle pointer is invalid")
        if not isinstance(event, GoalEvent):
            raise TypeError(f"update_goal_state(event: GoalEvent): got {event!r}")
        self._server.advance(self._goal, event)

    def _on_destroy(self) -> None:
        self._server.forget(self._goal)


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
    """The status array of a server, action_msgs/msg/GoalStatusArray; goals are in order of acceptance.

    A server publishes the states of all goals that it knows whenever one changes, and a client looks for the
    few that are its own. So a server changes bytes in place, and a client searches them: message objects
    would make each goal dearer by 1 us for every goal that is kept.
    """

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


_Part = Client | Service | Publisher | Subscription | Timer

# The order in which rcl counts entities; publishers are not waited for.
_WAITED_FOR = ("subscription", "guard_condition", "timer", "client", "service")


class ActionEntity(Destroyable):
    """Handles of one node under `<action name>/_action/` that are waited for and destroyed together.

    An action itself is not in the graph: peers may use its services and topics directly.
    """

    # The beginnings of errors, as rcl words them for the two kinds.
    _what: str
    _bad_name = "Failed to create {what} due to invalid topic name '{name}' : {reason}"
    _empty_name = _bad_name

    def __init__(self, node: Node, action_type: Any, action_name: str) -> None:
        super().__init__()
        action_name = as_c_string(
            action_name, self._empty_name.format(what=self._what, name=None, reason=""), ValueError
        )
        self._must_be_usable(node, action_type, action_name)
        self._node = node
        self._name = action_name
        self._full_name = node.resolve_name(action_name, is_service=False)
        for part in (action_type.Impl.SendGoalService, action_type.Impl.GetResultService):
            service_type(part).action = action_type
        message_type(action_type.Impl.FeedbackMessage).action = action_type
        self._parts: list[_Part] = []
        self._waited_for: list[tuple[str, Any]] = []  # (kind, handle) in the order of what `is_ready` returns
        # Their places in the wait set that they were added to last.
        self._indices: list[tuple[str, int]] = []

    @property
    def name(self) -> str:
        """The name that the program gave to the action."""
        return self._name

    def _own(self, part_class: Any, interface: Any, name: str, qos_profile: object) -> Any:
        """Create a hidden part; if that fails, nothing of the whole remains."""
        try:
            part = part_class(self._node, interface, _part_name(self._full_name, name), qos_profile)
        except RCLError as error:
            self._on_destroy()
            reason = str(error).partition(": ")[2]
            raise ValueError(f"Failed to create {self._what}: {reason}") from None
        except Exception:
            self._on_destroy()
            raise
        self._parts.append(part)
        return part

    def get_num_entities(self) -> tuple[int, ...]:
        """Count the subscriptions, guard conditions, timers, clients and services to wait for."""
        self._must_live(f"Failed to get number of entities for 'rcl_{self._what.replace(' ', '_')}_t'")
        kinds = [kind for kind, _ in self._waited_for]
        return tuple(kinds.count(kind) for kind in _WAITED_FOR)

    def add_to_waitset(self, wait_set: WaitSet) -> None:
        """Add everything that can be waited for to a wait set."""
        self._indices = [
            (kind, getattr(wait_set, f"add_{kind}")(handle)) for kind, handle in self._waited_for
        ]

    def configure_introspection(
        self, clock: Clock, pyqos_service_event_pub: object, introspection_state: ServiceIntrospectionState
    ) -> None:
        """Switch the events about what the three services send and receive."""
        self._must_live("Failed to configure action introspection")
        for part in self._parts:
            if isinstance(part, Client | Service):
                part.configure_introspection(clock, pyqos_service_event_pub, introspection_state)

    @property
    def handles(self) -> tuple[Any, ...]:
        """The entities that can be waited for, in the order of the result of `is_ready`."""
        return tuple(handle for _, handle in self._waited_for)

    def is_ready(self, wait_set: WaitSet) -> tuple[bool, ...]:
        """Return what of this the wait set, to which it was added, found ready."""
        return tuple(wait_set.is_ready(kind, index) for kind, index in self._indices)

    def _must_be_usable(self, node: Node, action_type: Any, name: str) -> None:
        """Refuse a context that is down and a bad name (ValueError), and what is no action (RuntimeError)."""
        if not node.context.valid:
            raise ValueError(f"Failed to create {self._what}: rcl node's context is invalid")
        if reason := _name_error(node, name):
            text = self._bad_name if name else self._empty_name
            raise ValueError(text.format(what=self._what, name=name, reason=reason))
        if not hasattr(getattr(action_type, "Impl", None), "SendGoalService"):
            raise RuntimeError(
                f"The action type provided is not valid ({action_type}), this might be a message or service"
            )

    def _must_live(self, failure: str) -> None:
        if self._destroyed:
            raise RCLError(f"{failure}: {self._what} pointer is invalid")

    def _on_destroy(self) -> None:
        for part in self._parts:
            part.destroy_when_not_in_use()


def _part_name(action_name: str, part: str) -> str:
    """Return the name of a hidden service or topic; it is remapped like any other."""
    return f"{action_name}/_action/{part}"


def _name_error(node: Node, action_name: str) -> str | None:
    """The reason why an action cannot have this name, expanded and remapped as that of a topic."""
    if not action_name:
        return "invalid empty action name"
    try:
        full_name = node.resolve_name(action_name, is_service=False)
        # The longest of the five names: if this one is short enough, all are.
        full_name = node.resolve_name(_part_name(full_name, "cancel_goal"), is_service=True)
    except ValueError as error:
        return str(error)
    error_of_remapped = rclpy_get_validation_error_for_full_topic_name(full_name)
    return error_of_remapped[0] if error_of_remapped else None
