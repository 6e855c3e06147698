"""The executor that works in the order in which things happen."""

from __future__ import annotations

from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def EventsExecutor(*, context: Context | None = None) -> Executor:
    """Make an executor that runs callbacks on the thread that spins, in the order in which they became due.

    :param context: None for the default one.
    """
    executor: Executor = _rclpy.EventsExecutor(context)
    return executor
