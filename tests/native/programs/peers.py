"""Services and an action of one side: `peers.py server|client compiled|ours`; the other side is another process."""

import sys

from common import never_compiled, rclpy, spin_until
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci

role, kind = sys.argv[1:]
if kind == "ours":
    SetBool, Trigger = (never_compiled(f"std_srvs/srv/{name}") for name in ("SetBool", "Trigger"))
    Fibonacci = never_compiled("test_msgs/action/Fibonacci")
for message in (SetBool.Request, Trigger.Response, Fibonacci.Goal):
    assert hasattr(message, "__serialize__") == (kind == "ours")

rclpy.init()
node = rclpy.create_node(f"{role}_{kind}")


def serve() -> None:
    def switch(request, response):
        response.success, response.message = request.data, f"läst {request.data}"
        return response

    def trigger(request, response):
        response.success, response.message = True, "triggered"
        return response

    def execute(goal):
        numbers = [0, 1]
        while len(numbers) <= goal.request.order:
            numbers.append(numbers[-1] + numbers[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal.succeed()
        return Fibonacci.Result(sequence=numbers)

    node.create_service(SetBool, "switch", switch)
    node.create_service(Trigger, "trigger", trigger)
    server = ActionServer(
        node,
        Fibonacci,
        "fibonacci",
        execute,
        goal_callback=lambda goal: GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT,
        cancel_callback=lambda goal: CancelResponse.ACCEPT,
        handle_accepted_callback=lambda goal: None if goal.request.order > 50 else goal.execute(),
    )
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        server.destroy()


def ask() -> None:
    def answer(future):
        spin_until(node, future.done)
        return future.result()

    switch, trigger = node.create_client(SetBool, "switch"), node.create_client(Trigger, "trigger")
    fibonacci = ActionClient(node, Fibonacci, "fibonacci")
    ready = (switch.service_is_ready, trigger.service_is_ready, fibonacci.server_is_ready)
    spin_until(node, lambda: all(is_ready() for is_ready in ready))
    for value in (True, False):
        switched = answer(switch.call_async(SetBool.Request(data=value)))
        print("switched", switched.success, switched.message)
    triggered = answer(trigger.call_async(Trigger.Request()))
    print("triggered", triggered.success, triggered.message)

    progress = []
    sent = fibonacci.send_goal_async(
        Fibonacci.Goal(order=5), lambda message: progress.append(list(message.feedback.sequence))
    )
    accepted = answer(sent)
    spin_until(node, lambda: len(progress) == 4)  # rclpy drops feedback that arrives after the result
    result = answer(accepted.get_result_async())
    print("result", result.status, list(result.result.sequence), progress)
    print("accepted", answer(fibonacci.send_goal_async(Fibonacci.Goal(order=-1))).accepted)
    deferred = answer(fibonacci.send_goal_async(Fibonacci.Goal(order=99)))
    canceled = answer(deferred.cancel_goal_async())
    ids = [bytes(info.goal_id.uuid) == bytes(deferred.goal_id.uuid) for info in canceled.goals_canceling]
    print("canceling", canceled.return_code, ids)


serve() if role == "server" else ask()
rclpy.try_shutdown()
