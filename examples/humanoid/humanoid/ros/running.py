"""Run a node; every node's `main` uses this."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from ..robot.table import ModelError  # not from where MuJoCo is: launch files import this module

_NOTING = 0.2  # s that rclpy has to note a signal


def run(make: Callable[[], Node], args: list[str] | None, refusal: type[Exception]) -> None:
    """Run a node until Ctrl-C or a shutdown from outside.

    A bad model file, or a parameter that the node refuses with its own `refusal`, ends it with one sentence.
    """
    rclpy.init(args=args)
    try:
        node = make()
    except (ModelError, refusal) as error:
        rclpy.try_shutdown()
        sys.exit(f"error: {error}")
    with until_shutdown():
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


@contextlib.contextmanager
def until_shutdown() -> Iterator[None]:
    """End quietly on Ctrl-C or a shutdown from outside, whatever was under way."""
    try:
        yield
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        # Publishing or taking a message fails in many ways when the context is shut down meanwhile. A signal
        # makes it fail even before rclpy has noted that signal, in a thread of its own.
        if not _ends_soon():
            raise


def _ends_soon() -> bool:
    """Wait a little for a shutdown that is under way, and return whether it came."""
    end = time.monotonic() + _NOTING
    while rclpy.ok() and time.monotonic() < end:
        time.sleep(0.01)
    return not rclpy.ok()
