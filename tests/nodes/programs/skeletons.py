"""Nodes as ifgen writes them, on a single thread: everything answers with defaults."""

import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.action import ActionClient
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from robot.arm import Arm
from robot.brain import Brain
from robot.gripper import Gripper
from robot.msg import Joint
from stage import Stage, say
from std_msgs.msg import Empty, Float64, String
from std_srvs.srv import Trigger

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)

rclpy.init()
arm, brain, gripper = Arm(parameter_overrides=[Parameter("names", value=["a"])]), Brain(), Gripper()
stage = Stage(arm, brain, gripper)


def execute(client: ActionClient) -> None:
    """Send a goal and print every response."""
    assert stage.until(client.server_is_ready) is True
    feedback: list[Fibonacci.Feedback] = []
    handle = stage.result(
        client.send_goal_async(Fibonacci.Goal(order=3), lambda message: feedback.append(message.feedback))
    )
    response = stage.result(handle.get_result_async())
    stage.until(lambda: feedback)
    say(
        "goal",
        handle.accepted,
        len(feedback),
        response.status == GoalStatus.STATUS_SUCCEEDED,
        response.result.sequence,
    )


# A plain node publishes at its rates and once at the start, and answers.
joints, states, beats = (
    stage.collect(Joint, "joint", BEST_EFFORT),
    stage.collect(String, "arm/state", LATCHED),
    [],
)
stage.peer.create_subscription(Empty, "beat", beats.append, BEST_EFFORT)
say("at its rates", stage.until(lambda: len(joints) > 3 and len(beats) > 3), joints[0])
say("once", stage.until(lambda: states), len(states))
say(
    "services",
    stage.call(Trigger, "arm/stop", Trigger.Request()),
    stage.call(AddTwoInts, "add", AddTwoInts.Request(a=1)),
)
execute(ActionClient(stage.peer, Fibonacci, "fibonacci"))

# A coroutine node does the same.
say("asked", stage.call(AddTwoInts, "brain/ask", AddTwoInts.Request(a=1)))
execute(ActionClient(stage.peer, Fibonacci, "brain/act"))

# A managed node does nothing until it is told.
widths, labels = stage.collect(Float64, "width"), stage.collect(String, "label", LATCHED)
stage.during(0.3)
say(
    "unconfigured",
    len(widths),
    len(labels),
    [name for name, _ in gripper.get_service_names_and_types() if "open" in name],
)


def change(transition: int) -> None:
    """Request a transition through its service; print the state after it."""
    request = ChangeState.Request(transition=Transition(id=transition))
    done = stage.call(ChangeState, "gripper/change_state", request).success
    say("state", done, stage.call(GetState, "gripper/get_state", GetState.Request()).current_state.label)


change(Transition.TRANSITION_CONFIGURE)
say("configured", stage.call(Trigger, "gripper/open", Trigger.Request()).success, len(widths), len(labels))
change(Transition.TRANSITION_ACTIVATE)
say("active", stage.until(lambda: len(widths) > 5 and labels))
execute(ActionClient(stage.peer, Fibonacci, "grip"))
change(Transition.TRANSITION_DEACTIVATE)
stage.during(0.2)
widths.clear()
stage.during(0.3)
say("inactive", len(widths))
change(Transition.TRANSITION_CLEANUP)
say(
    "cleaned up",
    list(gripper.subscriptions),
    [w for w in gripper.waitables if "Action" in type(w).__name__],
    [s.srv_name for s in gripper.services if "open" in s.srv_name],
)
change(Transition.TRANSITION_CONFIGURE)
change(Transition.TRANSITION_ACTIVATE)
say("active again", stage.until(lambda: len(widths) > 5))
change(Transition.TRANSITION_ACTIVE_SHUTDOWN)


class Clumsy(Gripper):
    """A node whose first configuration fails, and whose second activation raises."""

    attempts = 0

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Fail too late."""
        self.attempts += 1
        answer = super().on_configure(state)
        return TransitionCallbackReturn.FAILURE if self.attempts == 1 else answer

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Raise."""
        raise RuntimeError("no power")


clumsy = Clumsy(node_name="clumsy")
say(
    "fails", clumsy.trigger_configure().name, clumsy.trigger_configure().name, len(list(clumsy.subscriptions))
)
say("raises", clumsy.trigger_activate().name, len(list(clumsy.subscriptions)))
for node in (arm, brain, gripper, clumsy, stage.peer):
    node.destroy_node()
rclpy.shutdown()
