"""Concurrent goals that publish feedback, under a multi-threaded executor."""

import threading
import time

from common import rclpy
from humanoid_interfaces.action import PerformDance
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

GOALS = 8

rclpy.init()
node = rclpy.create_node("goals")
group = ReentrantCallbackGroup()


def execute(goal):
    for beat in range(20):
        goal.publish_feedback(PerformDance.Feedback(beat=beat))
    goal.succeed()
    return PerformDance.Result()


server = ActionServer(node, PerformDance, "dance", execute, callback_group=group)
client = ActionClient(node, PerformDance, "dance", callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
spinner = threading.Thread(target=executor.spin, daemon=True)
spinner.start()
assert client.wait_for_server(10.0)
feedback = []
finished = []


def when_accepted(future):
    future.result().get_result_async().add_done_callback(lambda done: finished.append(done.result().status))


for _ in range(GOALS):
    client.send_goal_async(PerformDance.Goal(), feedback.append).add_done_callback(when_accepted)
end = time.monotonic() + 20
while len(finished) < GOALS and time.monotonic() < end:
    time.sleep(0.01)
print("finished", finished, "feedback", bool(feedback))
executor.shutdown()
spinner.join(5)
node.destroy_node()
rclpy.shutdown()
