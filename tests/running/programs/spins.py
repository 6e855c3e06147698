"""Spins beside another program until it is interrupted, and prints nothing."""

import contextlib
import os
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException

rclpy.init(args=[])
node = rclpy.create_node("spins")
Path(os.environ["WAIT_FOR"]).touch()
with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(node)
