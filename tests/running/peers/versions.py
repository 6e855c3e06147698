"""A node with one of two versions of a type: `versions.py old|new FILE`. Its endpoint is made once FILE is there."""

import sys
from pathlib import Path

import rclpy
from ifgen.dynamic import class_from_text
from rclpy.executors import ExternalShutdownException

VERSIONS = {"old": "float32 x", "new": "float32 x\nfloat32 depth"}

version, file = sys.argv[1:]
cls = class_from_text("demo_msgs/msg/Point", VERSIONS[version])
rclpy.init()
node = rclpy.create_node(version)
seen: list[str] = []
ends: list[object] = []


def look() -> None:
    nodes = sorted(node.get_node_names())
    if nodes != seen:
        seen[:] = nodes
        print("nodes", *nodes, flush=True)
    if ends or not Path(file).exists():
        return
    if version == "old":
        ends.append(node.create_publisher(cls, "point", 10))
    else:
        ends.append(node.create_subscription(cls, "point", print, 10))
    print("made", flush=True)


node.create_timer(0.02, look)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
    print("ended", flush=True)
