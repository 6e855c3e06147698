"""Exits from a callback of an executor, in the way that its argument names."""

import sys

import helper  # noqa: F401
import rclpy
from rclpy.executors import MultiThreadedExecutor

how = sys.argv[1]
rclpy.init(args=sys.argv)
node = rclpy.create_node("callbacks")
codes = {"none": None, "number": 3, "text": "no luck"}


left = []


def leave():
    if left:  # another thread was faster
        return
    left.append(how)
    print("leaving")
    if how == "error":
        raise ValueError("in a callback")
    sys.exit(codes[how])


timer = node.create_timer(0.01, leave)
try:
    if sys.argv[2:] == ["many"]:
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()
    else:
        rclpy.spin(node)
finally:
    print("finally", rclpy.ok())
