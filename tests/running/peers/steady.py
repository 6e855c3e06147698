"""Programs for bad networks: `steady.py ROLE`, each in a node of the name of its role.

`count` publishes 300 numbers once somebody listens, and `gaps` says how many of them it has heard. `state` keeps a
number for those who come late and raises it, and serves an action without end; `watch` prints what it hears of the
number, and what became of the action.
"""

import sys
import time

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int64
from test_msgs.action import Fibonacci

NUMBERS = 300
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Steady(Node):
    def __init__(self, role: str) -> None:
        super().__init__(role)
        self._number = 0
        self._names: list[str] = []
        getattr(self, role)()
        self.create_timer(0.1, self._look)

    def _look(self) -> None:
        names = sorted(self.get_node_names())
        if names != self._names:
            self._names = names
            topics = sum(name in {"/numbers", "/state"} for name, _ in self.get_topic_names_and_types())
            print("nodes", *names, topics, flush=True)

    def count(self) -> None:
        self._publisher = self.create_publisher(Int64, "numbers", NUMBERS)
        self.create_timer(0.01, self._say)

    def _say(self) -> None:
        if self._publisher.get_subscription_count() and self._number < NUMBERS:
            self._number += 1
            self._publisher.publish(Int64(data=self._number))

    def gaps(self) -> None:
        self.create_subscription(Int64, "numbers", self._hear, NUMBERS)

    def _hear(self, message: Int64) -> None:
        self._number += 1
        if message.data % 100 == 0:
            print("heard", self._number, "of", message.data, flush=True)

    def state(self) -> None:
        self._publisher = self.create_publisher(Int64, "state", LATCHED)
        self._server = ActionServer(self, Fibonacci, "compute", self._compute)
        self.create_timer(0.5, self._raise)

    def _raise(self) -> None:
        self._number += 1
        self._publisher.publish(Int64(data=self._number))

    def _compute(self, goal):
        time.sleep(goal.request.order)
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1])

    def watch(self) -> None:
        self.create_subscription(
            Int64, "state", lambda message: print("state", message.data, flush=True), LATCHED
        )
        self._client = ActionClient(self, Fibonacci, "compute")
        self.create_timer(0.1, self._act)

    def _act(self) -> None:
        """Ask for a result as soon as the server is there, and say what comes of it."""
        if self._number or not self._client.server_is_ready():
            return
        self._number = 1
        self._client.send_goal_async(Fibonacci.Goal(order=1)).add_done_callback(self._accepted)

    def _accepted(self, sent) -> None:
        print("goal", sent.exception() or sent.result().accepted, flush=True)
        if sent.exception() is None:
            sent.result().get_result_async().add_done_callback(self._done)
        else:
            self._number = 0

    def _done(self, result) -> None:
        self._number = 0
        print("result", result.exception() or result.result().status, flush=True)


rclpy.init()
node = Steady(sys.argv[1])
executor = MultiThreadedExecutor(4)
executor.add_node(node)
try:
    executor.spin()
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
