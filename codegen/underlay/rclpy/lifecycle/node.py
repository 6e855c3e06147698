"""Nodes whose life is a state machine: configure, activate, deactivate, clean up, shut down."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from lifecycle_msgs import msg, srv

from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import wrong_return
from rclpy.impl.reexports import reexport
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.type_support import check_is_valid_srv_type

from .managed_entity import ManagedEntity, TransitionCallbackReturn
from .publisher import LifecyclePublisher

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.event_handler import PublisherEventCallbacks
    from rclpy.impl.typed import MessageT
    from rclpy.qos_overriding_options import QoSOverridingOptions

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

_SHUTDOWN_FROM = {
    "unconfigured": msg.Transition.TRANSITION_UNCONFIGURED_SHUTDOWN,
    "inactive": msg.Transition.TRANSITION_INACTIVE_SHUTDOWN,
    "active": msg.Transition.TRANSITION_ACTIVE_SHUTDOWN,
}


class LifecycleState(NamedTuple):
    """A state, as callbacks get it."""

    label: str
    state_id: int


class LifecycleNodeMixin(ManagedEntity):
    """A mixin that makes a node a managed one. Derive from it and Node, and call `Node.__init__` first.

    The node's own `on_*` callbacks pass each transition on to its managed entities, in no particular order;
    an override that wants this calls `super()`. An exception counts as ERROR.
    """

    def __init__(
        self,
        *,
        enable_communication_interface: bool = True,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self._callbacks: dict[int, Callable[[LifecycleState], TransitionCallbackReturn]] = {
            msg.State.TRANSITION_STATE_CONFIGURING: self.on_configure,
            msg.State.TRANSITION_STATE_CLEANINGUP: self.on_cleanup,
            msg.State.TRANSITION_STATE_SHUTTINGDOWN: self.on_shutdown,
            msg.State.TRANSITION_STATE_ACTIVATING: self.on_activate,
            msg.State.TRANSITION_STATE_DEACTIVATING: self.on_deactivate,
            msg.State.TRANSITION_STATE_ERRORPROCESSING: self.on_error,
        }
        self._managed_entities: set[ManagedEntity] = set()
        for srv_type in (
            srv.ChangeState,
            srv.GetState,
            srv.GetAvailableStates,
            srv.GetAvailableTransitions,
        ):
            check_is_valid_srv_type(srv_type)
        node: Any = self
        with node.handle:
            self._state_machine = _rclpy.LifecycleStateMachine(node.handle, enable_communication_interface)
        if enable_communication_interface:
            self.__serve(node, node.default_callback_group if callback_group is None else callback_group)

    def __serve(self, node: Any, group: CallbackGroup) -> None:
        machine = self._state_machine

        def service(handle: Any, srv_type: Any, callback: Callable[[Any, Any], Any]) -> Service:
            service = Service(handle, srv_type, handle.name, callback, group, QoSProfile(**handle.qos))
            group.add_entity(service)
            node._services.append(service)
            return service

        self._service_change_state = service(
            machine.service_change_state, srv.ChangeState, self.__on_change_state
        )
        self._service_get_state = service(machine.service_get_state, srv.GetState, self.__on_get_state)
        self._service_get_available_states = service(
            machine.service_get_available_states,
            srv.GetAvailableStates,
            self.__on_get_available_states,
        )
        self._service_get_available_transitions = service(
            machine.service_get_available_transitions,
            srv.GetAvailableTransitions,
            self.__on_get_available_transitions,
        )
        self._service_get_transition_graph = service(
            machine.service_get_transition_graph,
            srv.GetAvailableTransitions,
            self.__on_get_transition_graph,
        )

    # Each returns what the callback returned and raises RCLError where there is no such transition.

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Go from unconfigured to inactive."""
        return self.__change_state(msg.Transition.TRANSITION_CONFIGURE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Go from inactive to unconfigured."""
        return self.__change_state(msg.Transition.TRANSITION_CLEANUP)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Go to finalized."""
        transition = _SHUTDOWN_FROM.get(self._state_machine.current_state[1])
        if transition is None and distro.follows("trigger"):
            transition = msg.Transition.TRANSITION_UNCONFIGURED_SHUTDOWN  # which is refused with its name
        if transition is None:
            raise _rclpy.RCLError("Shutdown transtion not possible")
        return self.__change_state(transition)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Go from inactive to active."""
        return self.__change_state(msg.Transition.TRANSITION_ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Go from active to inactive."""
        return self.__change_state(msg.Transition.TRANSITION_DEACTIVATE)

    # Managed entities

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Add an entity to every transition. Raises TypeError unless it is a ManagedEntity."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._managed_entities.add(entity)

    if TYPE_CHECKING:  # upstream's signature says nothing

        def create_lifecycle_publisher(
            self,
            msg_type: type[MessageT],
            topic: str,
            qos_profile: QoSProfile | int,
            *,
            callback_group: CallbackGroup | None = None,
            event_callbacks: PublisherEventCallbacks | None = None,
            qos_overriding_options: QoSOverridingOptions | None = None,
            publisher_class: type[LifecyclePublisher[MessageT]] | None = None,
        ) -> LifecyclePublisher[MessageT]:
            """Create a publisher that is silent unless the node is active."""
            raise NotImplementedError

    else:

        def create_lifecycle_publisher(self, *args, **kwargs):
            """Create a publisher that is silent unless the node is active.

            Arguments as for `Node.create_publisher`.
            """
            if "publisher_class" in kwargs:
                distro.uses("publisher_class")
            kind = kwargs.pop("publisher_class", None) or LifecyclePublisher
            node: Any = self
            publisher = Node.create_publisher(node, *args, **kwargs, publisher_class=kind)
            assert isinstance(publisher, LifecyclePublisher)
            self._managed_entities.add(publisher)
            return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher[Any]) -> bool:
        """Destroy a publisher of this node; False if it is not one."""
        self._managed_entities.discard(publisher)
        node: Any = self
        return Node.destroy_publisher(node, publisher)

    def __transition_callback_impl(
        self, callback_name: str, state: LifecycleState
    ) -> TransitionCallbackReturn:
        """Return the first answer that is not SUCCESS."""
        for entity in list(self._managed_entities):
            answer = getattr(entity, callback_name)(state)
            if not isinstance(answer, TransitionCallbackReturn):
                raise TypeError(
                    f"{callback_name}() return value of class {type(entity)} "
                    "should be `TransitionCallbackReturn`.\n"
                    f"Instance of the class that caused the failure: {entity}"
                )
            if answer != TransitionCallbackReturn.SUCCESS:
                return answer
        return TransitionCallbackReturn.SUCCESS

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Configure the managed entities."""
        return self.__transition_callback_impl("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean up the managed entities."""
        return self.__transition_callback_impl("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut down the managed entities."""
        return self.__transition_callback_impl("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activate the managed entities."""
        return self.__transition_callback_impl("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate the managed entities."""
        return self.__transition_callback_impl("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Let the managed entities recover."""
        return self.__transition_callback_impl("on_error", state)

    # The state machine

    def __change_state(self, transition_id: int) -> TransitionCallbackReturn:
        machine = self.__checked_machine()
        state_id, label = machine.current_state
        if distro.follows("trigger") and all(
            each[0] != transition_id for each in machine.available_transitions
        ):
            text = f"Unable to start transition {transition_id} from current state {machine.current_state}"
            node: Any = self
            node.get_logger().error(text)
            return TransitionCallbackReturn.ERROR
        before = LifecycleState(label=label, state_id=state_id)
        machine.trigger_transition_by_id(transition_id, True)
        answer = self.__execute_callback(before)
        machine.trigger_transition_by_label(answer.to_label(), True)
        if answer == TransitionCallbackReturn.ERROR:
            recovery = self.__execute_callback(before)
            machine.trigger_transition_by_label(recovery.to_label(), True)
        return answer

    def __execute_callback(self, before: LifecycleState) -> TransitionCallbackReturn:
        """Run the callback of the state in which the machine is now.

        The log says why it counts as ERROR, which upstream does not.
        """
        state_id, label = self._state_machine.current_state
        callback = self._callbacks.get(state_id)
        if callback is None:
            return TransitionCallbackReturn.SUCCESS
        try:
            answer: object = callback(before)
        except Exception as error:
            fault = f"raised {type(error).__name__}: {error}\n{traceback.format_exc()}"
        else:
            if isinstance(answer, TransitionCallbackReturn):
                return answer
            fault = wrong_return("", answer, TransitionCallbackReturn).strip()
        node: Any = self
        node.get_logger().error(f"the callback of the transition state '{label}' {fault}")
        return TransitionCallbackReturn.ERROR

    def __checked_machine(self) -> Any:
        if not self._state_machine.initialized:
            raise RuntimeError(
                "Internal error: got service request while lifecycle state machine is not initialized."
            )
        return self._state_machine

    # The services

    def __on_change_state(self, request: Any, response: Any) -> Any:
        """Trigger a transition by id, or by label if there is one.

        False where there is no such transition now.
        """
        machine = self.__checked_machine()
        label, transition_id = request.transition.label, request.transition.id
        triggerable = {each[1]: each[0] for each in machine.available_transitions}
        if label:
            transition_id = triggerable.get(label)
        # Upstream's node dies from an impossible request, so no program can rely on that.
        response.success = (
            transition_id in triggerable.values()
            and self.__change_state(transition_id) == TransitionCallbackReturn.SUCCESS
        )
        return response

    def __on_get_state(self, request: Any, response: Any) -> Any:
        response.current_state.id, response.current_state.label = self.__checked_machine().current_state
        return response

    def __on_get_available_states(self, request: Any, response: Any) -> Any:
        response.available_states = [
            msg.State(id=state_id, label=label)
            for state_id, label in self.__checked_machine().available_states
        ]
        return response

    def __on_get_available_transitions(self, request: Any, response: Any) -> Any:
        response.available_transitions = _descriptions(self.__checked_machine().available_transitions)
        return response

    def __on_get_transition_graph(self, request: Any, response: Any) -> Any:
        response.available_transitions = _descriptions(self.__checked_machine().transition_graph)
        return response


def _descriptions(
    transitions: list[tuple[int, str, int, str, int, str]],
) -> list[msg.TransitionDescription]:
    return [
        msg.TransitionDescription(
            transition=msg.Transition(id=number, label=label),
            start_state=msg.State(id=start, label=start_label),
            goal_state=msg.State(id=goal, label=goal_label),
        )
        for number, label, start, start_label, goal, goal_label in transitions
    ]


class LifecycleNode(LifecycleNodeMixin, Node):
    """A managed node; keyword arguments as for `Node`."""

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
