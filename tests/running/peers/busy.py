"""Programs that end while they are busy: `busy.py serve|ask|publish HOW`; HOW is `stay`, `exit` or `raise`."""

import sys
import threading
import time

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

_ENOUGH = 20  # responses of a server that leaves


def serve() -> None:
    """Answer, perhaps until enough is enough."""
    answered = []

    def execute(goal):
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])

    def answer(_, response):
        answered.append(response)
        if len(answered) > _ENOUGH:
            leave()
        return response

    node.create_service(SetBool, "switch", answer)
    node.create_subscription(String, "chatter", lambda _: None, 10)
    kept = ActionServer(node, Fibonacci, "compute", execute)
    print("ready", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        kept.destroy()


def ask() -> None:
    """Keep daemon threads busy, and leave them to it."""
    publisher = node.create_publisher(String, "chatter", 10)
    client = node.create_client(SetBool, "switch")
    action = ActionClient(node, Fibonacci, "compute")
    assert client.wait_for_service(30.0)
    assert action.wait_for_server(30.0)
    done = [0, 0, 0]

    def publish():
        while True:
            publisher.publish(String(data="x" * 100))
            done[0] += 1

    def call():
        while True:
            client.call(SetBool.Request())
            client.call_async(SetBool.Request())  # nobody waits for this one
            done[1] += 1

    def act():
        while True:
            action.send_goal(Fibonacci.Goal(order=1))
            done[2] += 1

    works = {call: 1, act: 2} if role == "ask" else {publish: 0}
    for work in (lambda: rclpy.spin(node), *works):
        threading.Thread(target=work, daemon=True).start()
    while how == "stay" or not all(done[number] for number in works.values()):
        time.sleep(0.01)
    leave()


def leave() -> None:
    """End in one of the ways."""
    if how == "exit":
        sys.exit(0)
    if how == "raise":
        raise RuntimeError("on purpose")


role, how = sys.argv[1:3]
rclpy.init()
node = rclpy.create_node(role)
(serve if role == "serve" else ask)()
