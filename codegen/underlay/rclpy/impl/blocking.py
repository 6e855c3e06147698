"""Calls that wait, why one in a callback would block for ever (off by default), and `with` of entities."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar

from rmw_local import timing

from rclpy.impl import distro

if TYPE_CHECKING:
    from typing import Self

    from rclpy.executors import Executor
    from rclpy.node import Node


class Block:
    """A mixin for what a `with` block destroys at its end.

    `_ros_entity` is its name in `distro.API`, and `_ros_end` the method that destroys it.
    """

    _ros_entity: ClassVar[str]
    _ros_end: ClassVar[str] = "destroy"

    def __enter__(self) -> Self:
        distro.uses(self._ros_entity)
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        getattr(self, self._ros_end)()


class Owned(Block):
    """A mixin for an entity that its node lists; in newer ROS, until it is destroyed."""

    _owner: weakref.ref[Node] | None = None

    def destroy(self) -> None:
        """Destroy it."""
        entity: Any = super()
        entity.destroy()
        node = None if self._owner is None else self._owner()
        if node is not None:
            node._forget(self)


# Strict mode switches it on; then `Client.call`, `ActionClient.send_goal` and the waiting methods of goal
# handles ask `must_be_answerable` before they wait.
enabled = False


class SynchronousCallError(RuntimeError):
    """A call waits for a response where it can never be received."""


class _Running(threading.local):
    """The callbacks that this thread executes, innermost last."""

    def __init__(self) -> None:
        self.callbacks: list[tuple[Executor | None, Any]] = []


_running = _Running()


@contextmanager
def inside_callback(executor: Executor | None, entity: Any) -> Iterator[None]:
    """Note that this thread runs the callback of an entity, or a task (None), of an executor."""
    _running.callbacks.append((executor, entity))
    try:
        yield
    finally:
        _running.callbacks.pop()


def must_be_answerable(client: Any, call: str, instead: str, timeout_sec: float | None = None) -> None:
    """Raise SynchronousCallError with an explanation if a call here can only time out or block for ever.

    :param client: the service or action client that would receive the response. :param call: the call, for
    the text. :param instead: the expression that returns a future, for the text.
    """
    if enabled and (reason := _why_never_answered(client)) is not None:
        consequence = "block for ever" if timeout_sec is None else f"time out after {timeout_sec} s"
        raise SynchronousCallError(
            f"The call of {call} would {consequence}: {reason} "
            f"Use `await {instead}` in an `async def` callback, or `{instead}.add_done_callback(...)`."
        )


def _why_never_answered(client: Any) -> str | None:
    for executor, entity in reversed(_running.callbacks):
        if executor is None or client not in _clients_of(executor):
            continue  # another executor receives the response
        if entity is not None and entity.callback_group is client.callback_group and not _is_free(client):
            return (
                "it is called inside a callback of the client's own callback group, which lets nothing else "
                "run until that callback returns. Another callback group for the client would help with a "
                "MultiThreadedExecutor."
            )
        if _threads_of(executor) == 1:
            return (
                "it is called inside a callback that occupies the only thread of the executor that would "
                "have to receive the response."
            )
    return None


def _is_free(client: Any) -> bool:
    free: bool = client.callback_group.can_execute(client)
    return free


def _clients_of(executor: Executor) -> set[Any]:
    return {client for node in executor.get_nodes() for client in (*node.clients, *node.waitables)}


def _threads_of(executor: Executor) -> int:
    pool = getattr(executor, "_executor", None)
    return 1 if pool is None else int(pool._max_workers)


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
