"""Two processes: the talker stops the listener and publishes on, until the connection takes no more.

`stopping.py listen RELIABILITY DURABILITY`, then `stopping.py talk RELIABILITY DURABILITY PID`. The numbers are those
of rclpy's policies.
"""

import os
import signal
import sys
import time
from pathlib import Path

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

COUNT = 400  # of 20 kB: more than a connection holds


class Listener(Node):
    """Counts what it hears, and what is lost."""

    def __init__(self, qos: QoSProfile) -> None:
        super().__init__("listener")
        self.heard = self.lost = 0
        self.has_ended = False
        events = SubscriptionEventCallbacks(message_lost=self._lose)
        self.create_subscription(String, "word", self._hear, qos, event_callbacks=events)

    def _hear(self, message: String) -> None:
        self.heard += 1
        self.has_ended |= message.data == "end"

    def _lose(self, status: object) -> None:
        self.lost = status.total_count


def listen(qos: QoSProfile) -> None:
    node = Listener(qos)
    print("listening", flush=True)
    while not node.has_ended:
        rclpy.spin_once(node)
    for _ in range(10):
        rclpy.spin_once(node, timeout_sec=0.05)
    print("sum", node.heard + node.lost, "lost" if node.lost else "nothing lost", flush=True)


def talk(qos: QoSProfile, listener: int) -> None:
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(String, "word", qos)
    while not publisher.get_subscription_count():
        rclpy.spin_once(node, timeout_sec=0.05)
    publisher.publish(String(data="begin"))
    acked = [publisher.wait_for_all_acked(Duration(seconds=30))]
    stop(listener)
    for number in range(COUNT):
        publisher.publish(String(data=f"{number}".ljust(20_000)))
    begin = time.monotonic()
    acked.append(publisher.wait_for_all_acked(Duration(seconds=0.5)))
    is_late = time.monotonic() - begin > 2.0
    os.kill(listener, signal.SIGCONT)
    while not node.count_subscribers("word"):
        rclpy.spin_once(node, timeout_sec=0.05)
    time.sleep(1.0)  # what is sent into a full connection is lost, too
    publisher.publish(String(data="end"))
    acked.append(publisher.wait_for_all_acked(Duration(seconds=30)))
    print("acked", *acked, "late" if is_late else "in time", flush=True)


def stop(process: int) -> None:
    """Stop a process, and wait until its threads have: on a busy machine, they run on until its main thread does."""
    os.kill(process, signal.SIGSTOP)
    state = Path(f"/proc/{process}/stat")
    while state.read_text().rpartition(")")[2].split()[0] != "T":
        time.sleep(0.001)


rclpy.init()
role, reliability, durability, *rest = sys.argv[1:]
profile = QoSProfile(depth=1000, reliability=int(reliability), durability=int(durability))
if role == "listen":
    listen(profile)
else:
    talk(profile, int(rest[0]))
rclpy.shutdown()
