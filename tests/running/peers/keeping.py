"""One of several processes that keep a state: `keeping.py NAME`.

It publishes its name with a number on the topic `state`, which is transient local, until the number is 4 (`NAME:4`),
and one more whenever a process has appeared and answered. It prints each state that it hears, and the nodes whenever they change. Every
time it sees somebody, it calls the service `echo` of that process, and prints the answer.
"""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

KEPT = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
HEARD = QoSProfile(depth=50, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Keeper(Node):
    """Keeps the last three of its numbers for those who come late."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._number = self._count = 0
        self._nodes: list[str] = []
        self._state = self.create_publisher(String, "state", KEPT)
        self.create_subscription(String, "state", self._hear, HEARD)
        self.create_service(Trigger, f"{name}/echo", self._answer)
        for _ in range(4):
            self._publish()
        self.create_timer(0.02, self._look)

    def _publish(self) -> None:
        self._number += 1
        self._state.publish(String(data=f"{self.get_name()}:{self._number}"))

    def _hear(self, message: String) -> None:
        name, _, number = message.data.partition(":")
        if name != self.get_name():
            print("state", name, number, flush=True)

    def _answer(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = self.get_name()
        return response

    def _look(self) -> None:
        nodes, count = sorted(self.get_node_names()), self.count_publishers("state")
        if (nodes, count) == (self._nodes, self._count):
            return
        new, self._nodes, self._count = set(nodes) - {*self._nodes, self.get_name()}, nodes, count
        print("nodes", *nodes, "publishers", count, flush=True)
        for name in new:
            client = self.create_client(Trigger, f"{name}/echo")
            if client.wait_for_service(10.0):
                client.call_async(Trigger.Request()).add_done_callback(self._echoed)

    def _echoed(self, future: rclpy.Future) -> None:
        # Not before: Zenoh's subscribers let go of what was kept if a live message overtakes their question for it.
        self._publish()
        print("echo", future.result().message, flush=True)


rclpy.init()
node = Keeper(sys.argv[1])
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
