"""A node with the definitions of today among nodes with earlier ones: what it hears, asks and is answered."""

import sys
from importlib import import_module
from pathlib import Path

import adapters  # noqa: F401 - registers them
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from robot_msgs.action import Walk
from robot_msgs.msg import Speed
from robot_msgs.srv import Twice


def frozen(name):
    [path] = Path("adapters").glob(f"_{name.lower()}_*.py")
    return getattr(import_module(f"adapters.{path.stem}"), name)


class New(Node):
    on_type_mismatch = "adapt"


OldSpeed, OldTwice, OldWalk = map(frozen, ("Speed", "Twice", "Walk"))


def twice(request, response):
    response.b = 2 * request.a
    return response


def walk(goal):
    goal.publish_feedback(OldWalk.Feedback(feedback=3))
    goal.succeed()
    return OldWalk.Result(result=goal.request.goal)


rclpy.init()
old, new = rclpy.create_node("old"), New("new")
speeds = old.create_publisher(OldSpeed, "/speed", 10)
old.create_timer(0.05, lambda: speeds.publish(OldSpeed(value=7)))
old.create_service(OldTwice, "/twice", twice)
heard = []
new.create_subscription(Speed, "/speed", heard.append, 10)
client = new.create_client(Twice, "/twice")
executor = SingleThreadedExecutor()
executor.add_node(old)
executor.add_node(new)


def until(is_done):
    for _ in range(400):
        if is_done():
            return
        executor.spin_once(timeout_sec=0.05)
    raise SystemExit("nothing has happened within 20 s")


until(lambda: heard)
print(heard[0])
until(client.service_is_ready)
answer = client.call_async(Twice.Request(a=5))
until(answer.done)
print(answer.result())
if sys.argv[1:] == ["actions"]:
    server, walking = ActionServer(old, OldWalk, "/walk", walk), ActionClient(new, Walk, "/walk")
    until(walking.server_is_ready)
    told = []
    goal = walking.send_goal_async(Walk.Goal(goal=9), feedback_callback=told.append)
    until(goal.done)
    result = goal.result().get_result_async()
    until(lambda: result.done() and told)
    print(result.result().result, told[0].feedback)
    server.destroy()
    walking.destroy()
