"""`many.py NAME NODES ALL`: a process with so many nodes, each of which talks to all others.

It says when it sees ALL, and when somebody is gone.
"""

import sys
import time

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from std_msgs.msg import String

name, mine, everybody = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
rclpy.init()
begun = time.monotonic()
executor = SingleThreadedExecutor()
nodes = [rclpy.create_node(f"{name}_{number}") for number in range(mine)]
publishers = []
for node in nodes:
    executor.add_node(node)
    node.create_subscription(String, "all", lambda _: None, 10)
    publishers.append(node.create_publisher(String, "all", 10))
print("ready", flush=True)
try:
    while len(nodes[0].get_node_names()) < everybody or publishers[-1].get_subscription_count() < everybody:
        executor.spin_once(timeout_sec=0.01)
    used = time.process_time()
    print("sees all", round(time.monotonic() - begun, 2), round(used, 2), flush=True)
    while len(nodes[0].get_node_names()) == everybody or publishers[-1].get_subscription_count() == everybody:
        executor.spin_once(timeout_sec=0.01)
    print("sees fewer", flush=True)
    executor.spin()
except (KeyboardInterrupt, ExternalShutdownException):
    pass
