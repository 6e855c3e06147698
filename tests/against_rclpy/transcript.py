"""Helpers of the scenarios: bounded spinning, and one line for each outcome."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from typing import Any

_SOURCE = re.compile(r", at \S+\.c(pp)?:\d+")


def without_source(text: str) -> str:
    """Remove the place where an error was raised: ours are raised elsewhere, or in a base that newer ROS has."""
    return _SOURCE.sub("", text).replace("_Base", "")


def refused(label: str, call: Callable[[], Any]) -> None:
    """Print the class of what `call` raises; upstream's error has no text, but ours has one."""
    try:
        call()
    except Exception as error:
        print(f"{label}: {type(error).__name__}")


def attempt(label: str, call: Callable[[], Any], show: Callable[[Any], Any] = repr) -> Any:
    """Print what `call` returns, or the class and text of what it raises; return the value or None."""
    try:
        value = call()
    except BaseException as error:  # KeyboardInterrupt and SystemExit are outcomes too
        print(f"{label}: {type(error).__name__}: {without_source(str(error))}")
        return None
    print(f"{label}: {show(value)}")
    return value


def until(condition: Callable[[], Any], *nodes_or_executor: Any, seconds: float = 10.0) -> bool:
    """Spin (an executor, or nodes on the global one) until the condition holds; False after `seconds`."""
    import rclpy  # late import: a scenario may examine what importing rclpy does

    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        for each in nodes_or_executor:
            if hasattr(each, "spin_once"):
                each.spin_once(timeout_sec=0.02)
            else:
                rclpy.spin_once(each, timeout_sec=0.02)
        if not nodes_or_executor:
            time.sleep(0.01)
    return True


def spin_for(seconds: float, executor: Any) -> None:
    """Spin an executor for a fixed time, for events that must not happen or that the clock triggers."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=left)
