"""A lifecycle node that is led from another process through all of its transitions.

Only possible ones: upstream's node ends with an exception when it is asked for another one, ours says no.
"""

from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from stage import Stage
from std_msgs.msg import String


class Managed(LifecycleNode):
    """Fails, or raises, when it is told to."""

    def __init__(self) -> None:
        super().__init__("managed")
        self.outcomes = []
        self.publisher = self.create_lifecycle_publisher(String, "word", 10)

    def _outcome(self):
        return self.outcomes.pop(0) if self.outcomes else TransitionCallbackReturn.SUCCESS

    def on_configure(self, state):
        outcome = self._outcome()
        if outcome is None:
            raise ValueError("on purpose")
        return outcome

    def on_error(self, state):
        return self._outcome()


def managed(stage: Stage) -> None:
    """Is led."""
    node = stage.adopt(Managed())
    stage.meet()
    stage.meet()  # it is active
    node.publisher.publish(String(data="active"))
    stage.meet()  # it is inactive, then unconfigured
    node.publisher.publish(String(data="not active"))
    node.outcomes = [TransitionCallbackReturn.FAILURE, None, TransitionCallbackReturn.SUCCESS]
    stage.meet()
    stage.meet()
    node.outcomes = [TransitionCallbackReturn.ERROR, TransitionCallbackReturn.FAILURE]
    stage.meet()
    stage.meet()


def manager(stage: Stage) -> None:
    """Leads."""
    node = stage.node("manager")
    events, words = [], []
    node.create_subscription(
        TransitionEvent,
        "/managed/transition_event",
        lambda event: events.append((event.start_state.label, event.goal_state.label)),
        100,
    )
    node.create_subscription(String, "word", lambda message: words.append(message.data), 10)
    kinds = {
        "change_state": ChangeState,
        "get_state": GetState,
        "get_available_states": GetAvailableStates,
        "get_available_transitions": GetAvailableTransitions,
        "get_transition_graph": GetAvailableTransitions,
    }
    clients = {name: node.create_client(kind, f"/managed/{name}") for name, kind in kinds.items()}
    stage.until(lambda: all(client.service_is_ready() for client in clients.values()))
    stage.until(lambda: node.count_publishers("/managed/transition_event") and node.count_publishers("word"))
    stage.spin(0.5)
    stage.meet()

    def ask(name, **fields):
        return stage.result(clients[name].call_async(kinds[name].Request(**fields)))

    def state():
        return ask("get_state").current_state.label

    def lead(label):
        number = getattr(Transition, f"TRANSITION_{label.upper()}")
        stage.say(label, ask("change_state", transition=Transition(id=number)).success, state())
        stage.say([each.transition.label for each in ask("get_available_transitions").available_transitions])

    stage.say(state(), [each.label for each in ask("get_available_states").available_states])
    graph = ask("get_transition_graph").available_transitions
    stage.say(
        sorted((each.start_state.label, each.transition.label, each.goal_state.label) for each in graph)
    )
    for label in ("configure", "activate"):
        lead(label)
    stage.meet()
    stage.until(lambda: words)
    by_label = ask("change_state", transition=Transition(label="deactivate")).success
    stage.say("by its label", by_label, state())
    lead("cleanup")
    stage.meet()
    stage.meet()
    lead("configure")  # fails
    lead("configure")  # raises, and recovers
    lead("configure")
    lead("activate")
    lead("active_shutdown")
    stage.meet()
    stage.until(lambda: ("shuttingdown", "finalized") in events, "the last event")
    stage.say(words)
    for event in events:
        stage.say(*event)
    stage.meet()


ROLES = {
    "managed": managed,
    "manager": manager,
}
