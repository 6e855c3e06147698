"""The node of walker.py without the parameters that NoDL cannot describe."""

import contextlib

import rclpy
import walker
from rclpy.executors import ExternalShutdownException

rclpy.init(args=[])
node = walker.walker()
node.undeclare_parameter("a")
node.undeclare_parameter("bad-name")
with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(node)
