"""What the thread that looks for other definitions does besides: parameters, forks, two contexts, many nodes."""

import os
import sys
import threading

import ifgen.dynamic
from common import rclpy, spin_until
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.real_rclpy import tables
from ifgen_runtime.real_rclpy.guarded_subscriptions import TELLS_PUBLISHER
from ifgen_runtime.real_rclpy.watch import watch_of
from rcl_interfaces.msg import Log
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

Nameless, Nameless_ = (
    ifgen.dynamic.class_from_text("my_msgs/msg/Nameless", text)
    for text in ("float64 a", "float64 a\nint32 old")
)
Ours, Theirs = (
    ifgen.dynamic.class_from_text("my_msgs/msg/Speed", text) for text in ("float64 a", "float64 a\nint32 b")
)
MANY = int(sys.argv[1])
heard = []
reporting.listener = heard.append


def threads() -> int:
    return sum(thread.name == "ifgen type mismatch" for thread in threading.enumerate())


class Careful(Node):
    on_type_mismatch = "refuse"


class Adapted(Node):
    on_type_mismatch = "adapt"


rclpy.init()
print("before", threads())
careful = Careful("careful")
received = []
careful.create_subscription(Ours, "/one", received.append, 10)  # the first endpoint of all
wrong = [Parameter("on_type_mismatch", value="sometimes")]
try:
    Node("wrong", parameter_overrides=wrong).create_subscription(Ours, "/one", received.append, 10)
except ValueError as error:
    print(error)
adapted = Adapted("adapted")
unmoved = Careful("unmoved", parameter_overrides=[Parameter("on_type_mismatch", value="warn")])
unmoved.create_subscription(Ours, "/one", lambda message: None, 10)
print("running", threads())

child = os.fork()
if child == 0:
    os._exit(threads())
print("child", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))

peer = rclpy.create_node("peer")
watch = watch_of(careful.context)
look = watch._look
watch._look = lambda: None  # while they find each other: the side that is found first would speak
one = peer.create_publisher(Theirs, "/one", 10)
spin_until(peer, lambda: one.get_subscription_count() == 2 and unmoved.count_publishers("/one") == 1)
watch._look = look
spin_until(peer, lambda: len(heard) >= 2)
for mismatch in sorted(heard, key=lambda mismatch: mismatch.mine.node):
    print(mismatch.mine.node, mismatch.mine.role, mismatch.policy, mismatch.theirs.definition is not None)

second = Context()
second.init()
apart = Node("apart", context=second)
apart.create_publisher(Theirs, "/two", 10)
print("two contexts", threads())
apart.destroy_node()
second.shutdown()
spin_until(peer, lambda: threads() == 1)
print("one context", threads())

said = []
careful.create_subscription(
    Log, "/rosout", lambda log: said.append(log.msg) if "which definition" in log.msg else None, 10
)
careful.create_subscription(Nameless, "/three", received.append, 10)
unmoved.create_subscription(Nameless, "/four", lambda message: None, 10)
tables._HASH_VERSION = 0  # as before ROS 2 Iron
one, two = (peer.create_publisher(Nameless_, name, 10) for name in ("/three", "/four"))
tables._HASH_VERSION = 1
spin_until(careful, lambda: said)
one.publish(Nameless_(a=0.1))
spin_until(careful, lambda: received)
spin_until(careful, lambda: len(said) > 1, limit=1.0)  # it is not said twice
print("without a hash", len(said), [message.a for message in received])
received.clear()

adapted.create_subscription(Ours, "/five", received.append, 10)
five = peer.create_publisher(Theirs, "/five", 10)
register(Adapter(Theirs, Ours, lambda old: Ours(a=1 / old.a)))
spin_until(peer, five.get_subscription_count)
for a in (0.0, 0.5):
    five.publish(Theirs(a=a))
spin_until(adapted, lambda: received)
print("adapted", [message.a for message in received])
received.clear()

said = []
careful.create_subscription(
    Log, "/rosout", lambda log: said.append(log.msg) if "several definitions" in log.msg else None, 10
)
six = peer.create_publisher(Ours, "/five", 10)
spin_until(peer, six.get_subscription_count)
if not TELLS_PUBLISHER:
    spin_until(careful, lambda: said)
for publisher, message in ((five, Theirs(a=0.5)), (six, Ours(a=0.5))) * 3:
    publisher.publish(message)
    spin_until(adapted, lambda: len(received) == 6, limit=0.05)
mixed = {message.a for message in received}
received.clear()
peer.destroy_publisher(five)
spin_until(adapted, lambda: adapted.count_publishers("/five") == 1)
while not received:
    six.publish(Ours(a=4.0))
    spin_until(adapted, lambda: received, limit=0.05)
print("several definitions", len(said), sorted(mixed), received[0].a)
received.clear()

heard.clear()
for number in range(MANY):
    node = Node(f"passing_{number}", enable_rosout=False, start_parameter_services=False)
    node.create_publisher(Theirs, "/one", 1)
    if number % 50 == 49:
        spin_until(careful, lambda number=number: len(heard) >= 1)
    node.destroy_node()
spin_until(careful, lambda: len(watch._nodes) <= 4)
print("many", bool(heard), "watched nodes", sorted(node.node().get_name() for node in watch._nodes.values()))

rclpy.shutdown()
for thread in threading.enumerate():
    if thread.name == "ifgen type mismatch":
        thread.join(5)
print("after", threads(), received)
