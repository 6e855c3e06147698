"""One of several processes: publishes or hears numbers, and prints a line for each thing that it notices."""

import os
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Int64


class Peer(Node):
    """`peer.py NAME ROLE`: a role is `talk`, `listen`, `both` or `fork`."""

    def __init__(self, name: str, role: str) -> None:
        super().__init__(name)
        self._last = 0
        self._nodes: list[str] = []
        self._count = 0
        self._says = self.create_publisher(Int64, "count", 10) if role != "listen" else None
        if role in {"listen", "both"}:
            self.create_subscription(Int64, "count", self._hear, 10)
        self.create_timer(0.02, self._tick)
        if role == "fork":
            self.create_timer(0.5, self._fork)

    def _hear(self, message: Int64) -> None:
        self._last += 1
        if self._last == 1 or message.data % 10 == 0:
            print("heard", message.data, flush=True)

    def _tick(self) -> None:
        self._count += 1
        if self._says is not None:
            self._says.publish(Int64(data=self._count))
        nodes = sorted(self.get_node_names())
        if nodes != self._nodes:
            self._nodes = nodes
            print("nodes", *nodes, "zenoh" if "zenoh" in sys.modules else "alone", flush=True)

    def _fork(self) -> None:
        child = os.fork()
        if not child:
            rclpy.shutdown()
            sys.exit(7)
        print("child", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


rclpy.init()
node = Peer(*sys.argv[1:3])
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
