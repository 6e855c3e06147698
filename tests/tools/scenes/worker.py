"""Services and actions: one of each that works, one that refuses."""

from __future__ import annotations

import time

import rclpy
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci
from test_msgs.srv import BasicTypes

from tests.tools.scenes.stage import play


def switch(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    """Succeed if it is asked to switch on."""
    response.success, response.message = request.data, "on" if request.data else "it's off"
    return response


def same(request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
    """Return what was sent."""
    for field in request.get_fields_and_field_types():
        setattr(response, field, getattr(request, field))
    return response


def count(goal: ServerGoalHandle) -> Fibonacci.Result:
    """Feedback for each number; from ten on, slowly enough to be cancelled."""
    sequence = [0, 1]
    for _ in range(1, goal.request.order):
        if goal.is_cancel_requested:
            goal.canceled()
            return Fibonacci.Result(sequence=sequence)
        sequence.append(sequence[-1] + sequence[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        time.sleep(0.5 if goal.request.order >= 10 else 0.02)
    goal.succeed() if goal.request.order != 3 else goal.abort()
    return Fibonacci.Result(sequence=sequence)


def main() -> None:
    """Wait for requests and goals; goals below zero are rejected."""
    rclpy.init()
    worker, user = Node("worker", namespace="/plant"), Node("user")
    worker.create_service(SetBool, "switch", switch)
    worker.create_service(BasicTypes, "same", same)
    worker.create_service(Trigger, "_hidden", lambda _, response: response)
    server = ActionServer(
        worker,
        Fibonacci,
        "count",
        count,
        goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order >= 0 else GoalResponse.REJECT,
        cancel_callback=lambda _: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    ping = worker.create_service(Trigger, "ping", lambda _, response: response)
    ping.configure_introspection(
        worker.get_clock(), qos_profile_services_default, ServiceIntrospectionState.CONTENTS
    )
    caller = user.create_client(Trigger, "/plant/ping")
    user.create_timer(0.5, lambda: caller.call_async(Trigger.Request()))
    client = ActionClient(user, Fibonacci, "/plant/count")
    user.create_client(SetBool, "/plant/switch")
    play(worker, user)
    client.destroy()
    server.destroy()


if __name__ == "__main__":
    main()
