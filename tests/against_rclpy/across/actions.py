"""Actions: goals that are accepted, rejected, cancelled and aborted, with feedback and status."""

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.graph import get_action_names_and_types, get_action_server_names_and_types_by_node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from stage import Stage
from test_msgs.action import Fibonacci

SUCCEEDS, FAILS, WAITS, RAISES = 3, 4, 5, 6  # orders
NAMES = {value: name for name, value in vars(GoalStatus).items() if name.startswith("STATUS_")} | {
    getattr(GoalStatus, f"STATUS_{name}"): name
    for name in ("ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
}


def server(stage: Stage) -> None:
    """Computes, or waits to be cancelled."""
    node = stage.node("server")
    cancelled = []

    def on_cancel(goal):
        stubborn = goal.request.order == SUCCEEDS
        if not stubborn and cancelled:
            cancelled.pop().set_result(None)
        return CancelResponse.REJECT if stubborn else CancelResponse.ACCEPT

    async def execute(goal):
        order = goal.request.order
        goal.publish_feedback(Fibonacci.Feedback(sequence=[order]))
        if order == RAISES:
            raise ValueError("on purpose")
        if order == WAITS:
            future = Future()
            cancelled.append(future)
            await future
            goal.canceled()
        elif order == FAILS:
            goal.abort()
        else:
            goal.succeed()
        return Fibonacci.Result(sequence=[order, order])

    def on_goal(request):
        return GoalResponse.REJECT if request.order > 9 else GoalResponse.ACCEPT

    action = ActionServer(
        node, Fibonacci, "compute", execute, goal_callback=on_goal, cancel_callback=on_cancel
    )
    stage.meet()
    stage.meet()
    action.destroy()
    stage.meet()


def client(stage: Stage) -> None:
    """Sends goals."""
    node = stage.node("client")
    action = ActionClient(node, Fibonacci, "compute")
    stage.until(action.server_is_ready)
    statuses = []
    node.create_subscription(
        GoalStatusArray,
        "compute/_action/status",
        lambda message: statuses.append([NAMES[each.status] for each in message.status_list][-1:]),
        QoSProfile(depth=50, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    )
    stage.until(lambda: node.count_publishers("compute/_action/status"))
    stage.spin(0.3)
    stage.meet()
    for order in (SUCCEEDS, FAILS, RAISES):
        heard = []
        goal = stage.result(
            action.send_goal_async(
                Fibonacci.Goal(order=order),
                feedback_callback=lambda message, heard=heard: heard.append(list(message.feedback.sequence)),
            )
        )
        result = stage.result(goal.get_result_async())
        stage.say(
            order, goal.accepted, NAMES[result.status], list(result.result.sequence), NAMES.get(goal.status)
        )
    goal = stage.result(action.send_goal_async(Fibonacci.Goal(order=10)))
    stage.say("rejected", goal.accepted)

    heard = []
    goal = stage.result(
        action.send_goal_async(
            Fibonacci.Goal(order=WAITS),
            feedback_callback=lambda message: heard.append(list(message.feedback.sequence)),
        )
    )
    future = goal.get_result_async()
    stage.until(lambda: heard, "feedback")
    stage.say("feedback", heard, future.done())
    answer = stage.result(goal.cancel_goal_async())
    stage.say("cancel", answer.return_code, len(answer.goals_canceling))
    stage.say(NAMES[stage.result(future).status], list(future.result().result.sequence))
    answer = stage.result(goal.cancel_goal_async())
    stage.say("cancel again", answer.return_code, len(answer.goals_canceling))
    again = stage.result(goal.get_result_async())
    stage.say("result again", NAMES[again.status], list(again.result.sequence))
    stage.until(lambda: statuses[-1:] == [["CANCELED"]])
    stage.say([status for status, last in zip(statuses, [None, *statuses], strict=False) if status != last])
    names = dict(get_action_names_and_types(node))
    stage.say(names, get_action_server_names_and_types_by_node(node, "server", "/"))
    stage.meet()
    stage.meet()
    stage.until(lambda: not action.server_is_ready())
    stage.say("gone", action.server_is_ready(), action.wait_for_server(timeout_sec=0.05))
    action.destroy()


ROLES = {
    "server": server,
    "client": client,
}
