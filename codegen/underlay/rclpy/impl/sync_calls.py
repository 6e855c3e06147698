"""Explains why a service that is called synchronously inside a callback would block for ever. Off by default.

Strict mode switches it on (`enabled = True`); then `Client.call` asks `must_be_answerable` before it waits.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.client import Client
    from rclpy.executors import Executor

enabled = False


class SynchronousCallError(RuntimeError):
    """A service was called synchronously where the response can never be received."""


class _Running(threading.local):
    """What this thread is executing, innermost last."""

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


def must_be_answerable(client: Client, timeout_sec: float | None) -> None:
    """Raise SynchronousCallError with an explanation if a call here can only time out or block for ever."""
    if enabled and (reason := _why_never_answered(client)) is not None:
        consequence = "block for ever" if timeout_sec is None else f"time out after {timeout_sec} s"
        raise SynchronousCallError(
            f"The call of service '{client.srv_name}' would {consequence}: {reason} "
            "Use `await client.call_async(request)` in an `async def` callback, or "
            "`client.call_async(request).add_done_callback(...)`."
        )


def _why_never_answered(client: Client) -> str | None:
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


def _is_free(client: Client) -> bool:
    return client.callback_group.can_execute(client)


def _clients_of(executor: Executor) -> set[Any]:
    return {client for node in executor.get_nodes() for client in node.clients}


def _threads_of(executor: Executor) -> int:
    pool = getattr(executor, "_executor", None)
    return 1 if pool is None else int(pool._max_workers)
