"""Waiting until the graph is as somebody wants it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rmw_local import timing

# Nothing announces a context's shutdown to the threads that wait here, so they look again now and then [ns].
_LOOK_AGAIN = 100_000_000


def wait_for_graph(node_handle: Any, is_satisfied: Callable[[], bool], timeout: float | None) -> bool:
    """Wait until `is_satisfied()`, at most `timeout` [s] (None: no limit); returns whether it is.

    It is asked at once, after every change of the graph, and ten times a second. What it raises ends the
    wait, and so does the end of the node's context.
    """
    changed = node_handle.graph_node.participant.domain.changed
    waker = timing.make_waker()
    until = timing.deadline(None if timeout is None else max(timeout, 0.0))
    changed.add_listener(waker.wake)
    try:
        while not is_satisfied():
            if not node_handle.context.valid:
                return False
            look_again = timing.monotonic_ns() + _LOOK_AGAIN
            if until is not None and look_again >= until:
                if not timing.wait(waker, until):
                    return is_satisfied()
            else:
                timing.wait(waker, look_again)
    finally:
        changed.remove_listener(waker.wake)
    return True
