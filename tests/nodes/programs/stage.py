"""Helpers of the programs: one executor for the nodes under test and a peer, and waiting with a limit."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

LIMIT = 20.0  # [s] for one thing to happen


class Stage:
    """A single-threaded executor, which a synchronous deadlock would stop for ever."""

    def __init__(self, *nodes: Any) -> None:
        self.peer = rclpy.create_node("peer")
        self.executor = SingleThreadedExecutor()
        for node in (*nodes, self.peer):
            self.executor.add_node(node)

    def until(self, condition: Callable[[], Any]) -> Any:
        """Spin until a condition holds; return its value, or "too late"."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            if found := condition():
                return found
            self.executor.spin_once(timeout_sec=0.02)
        return "too late"

    def during(self, seconds: float) -> None:
        """Spin for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def result(self, future: Any) -> Any:
        """Spin until a future is done; return its result."""
        return future.result() if self.until(future.done) is True else "too late"

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Call a service."""
        client = self.peer.create_client(kind, name)
        assert self.until(client.service_is_ready) is True, f"no service {name}"
        return self.result(client.call_async(request))

    def collect(self, kind: Any, name: str, qos: Any = 10) -> list[Any]:
        """Collect what arrives on a topic from now on."""
        heard: list[Any] = []
        self.peer.create_subscription(kind, name, heard.append, qos)
        return heard


def say(what: str, *values: object) -> None:
    """Print one line that a test compares."""
    print(f"{what}:", *values, flush=True)
