"""Managed nodes: the state machine, callbacks and their failures, entities, services, events."""

from __future__ import annotations

from typing import Any

import rclpy
import rclpy.lifecycle
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.lifecycle import (
    LifecycleNode,
    LifecycleState,
    ManagedEntity,
    SimpleManagedEntity,
    TransitionCallbackReturn,
)
from std_msgs.msg import String
from transcript import attempt, until

SUCCESS, FAILURE, ERROR = (
    TransitionCallbackReturn.SUCCESS,
    TransitionCallbackReturn.FAILURE,
    TransitionCallbackReturn.ERROR,
)


def machine() -> None:
    """The state machine's handle."""
    node = LifecycleNode("lc")
    handle = node._state_machine
    for name in (
        "current_state",
        "available_states",
        "available_transitions",
        "transition_graph",
        "initialized",
    ):
        attempt(name, lambda name=name: getattr(handle, name))
    for label in ("configure", "cleanup", "shutdown", "transition_success", "nope"):
        attempt(label, lambda label=label: handle.get_transition_by_label(label))
    for kind in (
        "change_state",
        "get_state",
        "get_available_states",
        "get_available_transitions",
        "get_transition_graph",
    ):
        attempt(kind, lambda kind=kind: getattr(handle, f"service_{kind}").name)
        attempt(kind, lambda kind=kind: sorted(getattr(handle, f"service_{kind}").qos))
    each = list(TransitionCallbackReturn.__members__.values())
    attempt("enum", lambda: [(one.name, one.value, str(one), int(one), one.to_label()) for one in each])
    attempt("enum", lambda: (SUCCESS == 97, TransitionCallbackReturn(97) == SUCCESS, SUCCESS != ERROR))
    attempt("by id", lambda: handle.trigger_transition_by_id(3, True))
    attempt("by label", lambda: handle.trigger_transition_by_label("activate", True))
    attempt("unknown", lambda: handle.trigger_transition_by_label("zz", True))
    attempt("shutdown", lambda: handle.trigger_transition_by_label("shutdown", True))
    attempt("state", lambda: handle.current_state)
    attempt("outcome", lambda: handle.trigger_transition_by_id(52, True))
    attempt("state", lambda: handle.current_state)
    attempt("outcome", lambda: handle.trigger_transition_by_label("transition_failure", False))
    attempt("state", lambda: handle.current_state)
    attempt("services", lambda: sorted(service.srv_name for service in node.services))
    attempt("topics", lambda: node.get_publisher_names_and_types_by_node("lc", "/"))
    attempt("publishers", lambda: [publisher.topic_name for publisher in node.publishers])
    node.destroy_node()
    quiet = LifecycleNode("quiet", enable_communication_interface=False)
    attempt("no services", lambda: sorted(service.srv_name for service in quiet.services))
    attempt("none", lambda: quiet._state_machine.service_get_state)
    attempt("topics", lambda: quiet.get_publisher_names_and_types_by_node("quiet", "/"))
    quiet.destroy_node()
    attempt("bad", lambda: isinstance(_rclpy.LifecycleStateMachine, type))
    attempt("positional", lambda: LifecycleNode("x", True))
    attempt(
        "aliases", lambda: rclpy.lifecycle.Node is LifecycleNode and rclpy.lifecycle.State is LifecycleState
    )
    attempt("state", lambda: LifecycleState("a", 1))


def walks() -> None:
    """Walk through the graph by methods, with good and bad answers."""
    node = LifecycleNode("walker")
    steps = (
        "activate", "configure", "configure", "activate", "cleanup", "deactivate", "cleanup", "configure", "activate",
        "shutdown", "shutdown", "configure",
    )  # fmt: skip
    for step in steps:
        attempt(step, getattr(node, f"trigger_{step}"))
        attempt("state", lambda: node._state_machine.current_state)
    node.destroy_node()

    def odd(name: str, **answers: Any) -> None:
        def callback(answer: Any) -> Any:
            def on(self: Any, state: Any) -> Any:
                print("called with", state)
                if isinstance(answer, Exception):
                    raise answer
                return answer

            return on

        kind = type("Odd", (LifecycleNode,), {key: callback(answer) for key, answer in answers.items()})
        made = kind(name)
        for step in ("configure", "activate", "deactivate", "cleanup", "shutdown"):
            attempt(f"{name} {step}", getattr(made, f"trigger_{step}"))
            attempt("state", lambda: made._state_machine.current_state)
        made.destroy_node()

    odd("error_handled", on_configure=ERROR, on_error=SUCCESS)
    odd("error_not_handled", on_configure=ERROR, on_error=FAILURE)
    odd("error_in_error", on_activate=ERROR, on_error=ERROR)
    odd("error_raises", on_configure=ERROR, on_error=ValueError("x"))
    odd("raises", on_activate=ValueError("x"))
    odd("fails", on_configure=FAILURE, on_shutdown=FAILURE)
    odd("fails_later", on_activate=FAILURE)
    odd("deactivation_fails", on_deactivate=FAILURE, on_shutdown=ERROR)
    odd("cleanup_fails", on_cleanup=FAILURE)

    class NoArgument(LifecycleNode):
        def on_configure(self) -> Any:  # type: ignore[override]
            return SUCCESS

    node = NoArgument("no_argument")
    attempt("no argument", node.trigger_configure)
    node.destroy_node()


class Switch(SimpleManagedEntity):
    """Counts in both states."""

    @SimpleManagedEntity.when_enabled
    def on(self, number: int = 1, *, times: int = 2) -> int:
        """Print when enabled."""
        print("on", number, times)
        return 5

    @SimpleManagedEntity.when_enabled(when_not_enabled=lambda: print("is off"))
    def told(self) -> int:
        """Print in any case."""
        print("told")
        return 6


def entities() -> None:
    """Managed entities and publishers."""
    switch = Switch()
    attempt("off", lambda: (switch.on(), switch.told(), switch.is_activated))
    node = LifecycleNode("owner")
    node.add_managed_entity(switch)
    attempt("no entity", lambda: node.add_managed_entity(1))
    heard: list[str] = []
    node.create_subscription(String, "t", lambda message: heard.append(message.data), 10)
    publisher = node.create_lifecycle_publisher(String, "t", 10)
    print(until(lambda: publisher.get_subscription_count() == 1, node))
    attempt(
        "inactive",
        lambda: (publisher.is_activated, publisher.publish(String(data="lost")), publisher.publish(3)),
    )
    node.trigger_configure()
    node.trigger_activate()
    attempt("on", lambda: (switch.on(3, times=4), switch.told(), switch.is_activated, Switch.on.__name__))
    attempt("active", lambda: (publisher.is_activated, publisher.publish(String(data="heard"))))
    attempt("wrong", lambda: publisher.publish(3))
    print(until(lambda: heard, node), heard)
    node.trigger_deactivate()
    attempt(
        "inactive",
        lambda: (publisher.is_activated, switch.is_activated, publisher.publish(String(data="lost"))),
    )
    node.trigger_activate()
    publisher.publish(String(data="again"))
    print(until(lambda: len(heard) == 2, node), heard)
    attempt("destroy", lambda: node.destroy_lifecycle_publisher(publisher))
    attempt("destroy", lambda: node.destroy_lifecycle_publisher(publisher))

    class Bad(ManagedEntity):
        def __init__(self, answer: Any) -> None:
            self.answer = answer

        def on_deactivate(self, state: Any) -> Any:
            return self.answer

    node.add_managed_entity(Bad(FAILURE))
    attempt("entity refuses", node.trigger_deactivate)
    attempt("state", lambda: node._state_machine.current_state)
    node.add_managed_entity(Bad(5))
    attempt("state", lambda: node._state_machine.current_state)
    node.destroy_node()
    attempt("handle", lambda: node._state_machine.current_state)


def services() -> None:
    """A client drives a node through its services and listens to its events."""
    managed = LifecycleNode("managed", namespace="/ns")
    client = rclpy.create_node("driver")
    heard: list[TransitionEvent] = []
    client.create_subscription(TransitionEvent, "/ns/managed/transition_event", heard.append, 10)
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(managed)
    executor.add_node(client)

    def call(service_type: Any, name: str, request: Any) -> Any:
        caller = client.create_client(service_type, f"/ns/managed/{name}")
        caller.wait_for_service()
        future = caller.call_async(request)
        executor.spin_until_future_complete(future, 5.0)
        client.destroy_client(caller)
        return future.result()

    def change(**kwargs: Any) -> bool:
        return call(ChangeState, "change_state", ChangeState.Request(transition=Transition(**kwargs))).success

    def state() -> Any:
        current: State = call(GetState, "get_state", GetState.Request()).current_state
        return current.id, current.label

    def described(name: str) -> Any:
        answer = call(GetAvailableTransitions, name, GetAvailableTransitions.Request())
        return [
            (each.transition.id, each.transition.label, each.start_state.label, each.goal_state.label)
            for each in answer.available_transitions
        ]

    print(until(lambda: client.count_publishers("/ns/managed/transition_event") == 1, executor))
    attempt("state", state)
    states = call(GetAvailableStates, "get_available_states", GetAvailableStates.Request()).available_states
    print([(each.id, each.label) for each in states])
    attempt("graph", lambda: described("get_transition_graph"))
    attempt("bad label", lambda: change(label="nope"))
    for request in (
        {"id": 1},
        {"label": "activate"},
        {"id": 1, "label": "deactivate"},
        {"id": 2},
        {"label": "shutdown"},
    ):
        attempt("available", lambda: described("get_available_transitions"))
        attempt(str(request), lambda request=request: change(**request))
        attempt("state", state)
    print(until(lambda: len(heard) == 10, executor))
    for event in heard:
        print(event.start_state.id, event.start_state.label, event.goal_state.id, event.goal_state.label)
    executor.shutdown()
    managed.destroy_node()
    client.destroy_node()


def main() -> None:
    """Print all of it."""
    rclpy.init()
    machine()
    walks()
    entities()
    services()
    rclpy.shutdown()
