"""Servers of actions: an accepted cancel request cancels the task that executes the goal."""

from __future__ import annotations

import asyncio
import inspect
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle

from rclpy_asyncio.driver import MOST_AT_ONCE, Driver, Port, take_waitable


@dataclass(frozen=True, kw_only=True)
class ActionCallbacks:
    """Functions or coroutine functions: what executes goals, and what decides about goals and their end."""

    execute: Callable[[Any], Any]
    goal: Callable[[Any], Any]
    cancel: Callable[[Any], Any]


class AsyncActionServer:
    """Executes goals as tasks; made by `AsyncNode.create_action_server`."""

    def __init__(
        self,
        driver: Driver,
        action_type: Any,
        action_name: str,
        callbacks: ActionCallbacks,
        on_destroy: Callable[[AsyncActionServer], object],
        *,
        concurrent: bool | int,
        **options: Any,
    ) -> None:
        self._driver = driver
        self._callbacks = callbacks
        self._on_destroy = on_destroy
        self._limit = MOST_AT_ONCE if concurrent is True else max(int(concurrent), 1)
        self._accepted: deque[ServerGoalHandle[Any]] = deque()  # wait for their turn
        self._executing: dict[bytes, asyncio.Task[Any] | None] = {}  # by id; None until the task has begun
        self._is_ending = False
        self._is_destroyed = False
        self._server: Any = ActionServer(
            driver.node,
            action_type,
            action_name,
            self._execute,
            goal_callback=callbacks.goal,
            handle_accepted_callback=self._accept,
            cancel_callback=self._decide,
            **options,
        )
        # A callback that takes its time must not keep other requests waiting.
        is_slow = any(map(inspect.iscoroutinefunction, (callbacks.goal, callbacks.cancel)))
        ports = take_waitable(driver, self._server)
        port = Port(driver, self._server, *ports, limit=MOST_AT_ONCE if is_slow else 1)
        driver.serve(self._server, port.serve)

    def destroy(self) -> None:
        """Cancel the tasks of its goals and, once these have ended, destroy it."""
        if not self.begin_to_end() and not self._is_destroyed:
            self._is_destroyed = True
            self._driver.forget(self._server)
            self._on_destroy(self)
            self._server.destroy()

    def begin_to_end(self) -> bool:
        """Abort all goals, or end them as cancelled if that was asked for; False if there are none left."""
        if not self._is_ending:
            self._is_ending = True
            for task in self._executing.values():
                if task is not None:
                    task.cancel()
            self._limit += len(self._accepted)
            self._begin()
        return bool(self._executing)

    def _accept(self, goal_handle: ServerGoalHandle[Any]) -> None:
        self._accepted.append(goal_handle)
        self._begin()

    def _begin(self) -> None:
        """Execute the goals whose turn it is."""
        while self._accepted and len(self._executing) < self._limit:
            goal_handle = self._accepted.popleft()
            self._executing[bytes(goal_handle.goal_id.uuid)] = None
            goal_handle.execute()

    async def _decide(self, goal_handle: ServerGoalHandle[Any]) -> Any:
        response = self._callbacks.cancel(goal_handle)
        if inspect.isawaitable(response):
            response = await response
        if response == CancelResponse.ACCEPT:
            # The goal's state changes, and the client gets its response, when this has returned.
            self._driver.loop.call_soon(self._cancel, goal_handle)
        return response

    def _cancel(self, goal_handle: ServerGoalHandle[Any]) -> None:
        if not goal_handle.is_cancel_requested:
            return
        key = bytes(goal_handle.goal_id.uuid)
        task = self._executing.get(key)
        if task is not None:
            task.cancel()
        elif goal_handle in self._accepted:
            self._accepted.remove(goal_handle)
            self._executing[key] = None
            goal_handle.execute()

    async def _execute(self, goal_handle: ServerGoalHandle[Any]) -> Any:
        """Run the callback, see to it that the goal ends, and return its result."""
        key = bytes(goal_handle.goal_id.uuid)
        task = asyncio.current_task()
        assert task is not None
        self._executing[key] = task
        result, is_cancelled = None, False
        try:
            if self._is_ending or goal_handle.is_cancel_requested:
                is_cancelled = True
            else:
                begun = self._callbacks.execute(goal_handle)
                result = await begun if inspect.isawaitable(begun) else begun
        except asyncio.CancelledError:
            is_cancelled = True
            task.uncancel()  # whoever asked for this wants the goal to end, and it does
        except Exception as error:
            is_cancelled = True
            # The client is told before the exception ends the node.
            self._driver.loop.call_soon(self._driver.fail, error)
        if goal_handle.is_active:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
            elif is_cancelled:
                goal_handle.abort()
        self._driver.loop.call_soon(self._forget, key)
        return self._server.action_type.Result() if result is None else result

    def _forget(self, key: bytes) -> None:
        self._executing.pop(key, None)
        if not self._is_ending:
            self._begin()
        elif not self._executing:
            self.destroy()
