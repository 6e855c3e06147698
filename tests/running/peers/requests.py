"""A client and a server: `requests.py hold` answers nothing, `answer` answers, `ask` asks until it is answered."""

import sys

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.task import Future
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci


async def hold(*_):
    """Answer nothing."""
    print("held", flush=True)
    await Future()


def serve(callback):
    """Offer a service and an action."""
    kept = node.create_service(SetBool, "switch", callback), ActionServer(node, Fibonacci, "compute", hold)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        kept[1].destroy()


def ask():
    """Ask for what nobody answers, then for what somebody does."""
    client, action = node.create_client(SetBool, "switch"), ActionClient(node, Fibonacci, "compute")
    action.wait_for_server()
    sent = action.send_goal_async(Fibonacci.Goal())
    rclpy.spin_until_future_complete(node, sent)
    for future in (client.call_async(SetBool.Request()), sent.result().get_result_async()):
        print("asked", flush=True)
        rclpy.spin_until_future_complete(node, future)
        try:
            future.result()
        except Exception as error:
            print("failed", type(error).__name__, error, flush=True)
    client.wait_for_service()
    future = client.call_async(SetBool.Request())
    rclpy.spin_until_future_complete(node, future)
    print("answered", future.result().success, flush=True)


role = sys.argv[1]
rclpy.init()
node = rclpy.create_node(role)
if role == "ask":
    ask()
else:
    serve(hold if role == "hold" else lambda _, response: response)
