"""The common part of the handles of action clients and servers: several handles that count as one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rmw_local.message import message_type, service_type

from .clock import Clock, Timer
from .handle import Destroyable, RCLError
from .names import as_c_string, rclpy_get_validation_error_for_full_topic_name
from .service_introspection import ServiceIntrospectionState
from .services import Client, Service
from .topics import Publisher, Subscription

if TYPE_CHECKING:
    from .node import Node
    from .wait_set import WaitSet

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
