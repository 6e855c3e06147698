"""Clients of actions: a goal is awaited, and cancelling the task cancels the goal."""

from __future__ import annotations

import asyncio
import inspect
from collections import deque
from collections.abc import AsyncIterator, Callable
from types import TracebackType
from typing import Any

from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.qos import QoSProfile
from rclpy.task import Future

from rclpy_asyncio.driver import Driver, Port, follow, take_waitable, wrap_future


class GoalRejectedError(RuntimeError):
    """The server did not accept the goal."""


class AsyncActionClient:
    """Sends goals to the servers of an action; made by `AsyncNode.create_action_client`."""

    def __init__(
        self,
        driver: Driver,
        action_type: Any,
        action_name: str,
        on_destroy: Callable[[AsyncActionClient], object],
        *,
        feedback_sub_qos_profile: QoSProfile,
        **profiles: Any,
    ) -> None:
        self._driver = driver
        self._name = action_name
        self._client: Any = ActionClient(
            driver.node,
            action_type,
            action_name,
            feedback_sub_qos_profile=feedback_sub_qos_profile,
            **profiles,
        )
        self._depth = feedback_sub_qos_profile.depth
        self._on_destroy = on_destroy
        self._is_destroyed = False
        self._goals: dict[AsyncGoalHandle, None] = {}  # those that have not ended; a set with order
        self._results: deque[Any] = deque()  # responses that wait until all feedback is taken
        self._take_ready, run = take_waitable(driver, self._client)
        driver.serve(self._client, Port(driver, self._client, self._take, run).serve)

    def server_is_ready(self) -> bool:
        """Return whether a server is there, with all of its services and topics."""
        ready: bool = self._client.server_is_ready()
        return ready

    async def wait_for_server(self, *, check_interval: float = 0.1) -> None:
        """Wait until a server is there.

        :param check_interval: how often to look [s], where rclpy announces no change of the graph.
        :raises RuntimeError: if the node does not run.
        """
        self._driver.must_run(f"wait for the server of {self._name}")
        await self._driver.sources.until(self.server_is_ready, check_interval)

    async def send_goal(
        self,
        goal: Any,
        *,
        feedback_callback: Callable[[Any], Any] | None = None,
        goal_uuid: Any = None,
    ) -> Any:
        """Send a goal, wait until it has ended, and return the response with `status` and `result`.

        If the task is cancelled, so is the goal: the CancelledError goes on once the server has answered.

        :param feedback_callback: a function or coroutine function of each feedback message.
        :param goal_uuid: the id (unique_identifier_msgs/msg/UUID); None for a random one.
        :raises GoalRejectedError: if the server does not accept the goal.
        :raises RuntimeError: if the client is destroyed, or the node does not run.
        """
        handle = self.goal(goal, feedback_callback=feedback_callback, goal_uuid=goal_uuid)
        await handle.open()
        try:
            return await handle.result()
        except asyncio.CancelledError:
            await handle.close(wait=False)
            raise

    def goal(
        self,
        goal: Any,
        *,
        feedback_callback: Callable[[Any], Any] | None = None,
        goal_uuid: Any = None,
    ) -> AsyncGoalHandle:
        """Return a goal for `async with`, which begins when the server has accepted it.

        Leaving the block early cancels the goal and waits for its end; if the server refuses to cancel it,
        a warning says that it goes on. Parameters and errors are those of `send_goal`.
        """
        return AsyncGoalHandle(self, goal, feedback_callback, goal_uuid)

    def destroy(self) -> None:
        """Destroy it; whoever awaits one of its goals gets a CancelledError."""
        if self._is_destroyed:
            return
        self._is_destroyed = True
        for handle in list(self._goals):
            handle.drop()
        self._driver.forget(self._client)
        self._on_destroy(self)
        self._client.destroy()

    def _take(self) -> Any:
        """Take what is ready, and results last: rclpy drops the feedback that it takes after a result."""
        taken = self._take_ready()
        if taken is not None:
            if (result := taken[0].pop("result", None)) is not None:
                self._results.append(result)
            return taken
        if self._results:
            return ({"result": self._results.popleft()},)
        for handle in list(self._goals):
            handle.end_feedback()
        return None


class AsyncGoalHandle:
    """A goal that was sent; made by `AsyncActionClient.goal`, for `async with`."""

    def __init__(
        self,
        client: AsyncActionClient,
        goal: Any,
        feedback_callback: Callable[[Any], Any] | None,
        goal_uuid: Any,
    ) -> None:
        self._client: Any = client  # it shares what others need not see
        self._driver: Driver = self._client._driver
        self._goal = goal
        self._goal_uuid = goal_uuid
        self._feedback_callback = feedback_callback
        self._feedback: deque[Any] = deque(maxlen=max(self._client._depth, 1))
        self._news = asyncio.Event()  # set for each feedback, and at the end
        self._is_ended = False
        self._handle: ClientGoalHandle[Any]
        self._result_future: Future[Any] | None = None
        self._waiting: set[asyncio.Future[Any]] = set()  # for responses: destroying the client cancels them

    @property
    def goal_id(self) -> Any:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._handle.goal_id

    @property
    def accepted(self) -> bool:
        """Whether the server has accepted the goal."""
        return self._handle.accepted

    @property
    def stamp(self) -> Any:
        """The time when the server accepted the goal."""
        return self._handle.stamp

    @property
    def status(self) -> int:
        """The state, a value of action_msgs/msg/GoalStatus."""
        future = self._result_future
        if future is not None and future.done() and future.exception() is None:
            status: int = future.result().status
            return status
        return self._handle.status

    async def feedback(self) -> AsyncIterator[Any]:
        """Iterate over the feedback, from the first one on, until the goal has ended.

        Who is slow misses the oldest: as many are kept as the depth of the feedback's QoS says.
        """
        while True:
            while self._feedback:
                yield self._feedback.popleft()
            if self._is_ended:
                return
            self._news.clear()
            await self._news.wait()

    async def result(self) -> Any:
        """Wait until the goal has ended; the response has `status` and `result`. Any number may wait.

        :raises ServerGoneError: if the server leaves; only on the local transport, where that is known.
        """
        assert self._result_future is not None
        return await self._answer(self._result_future)

    async def cancel(self) -> CancelGoal.Response:
        """Ask for the goal to be cancelled, and return the response."""
        response: CancelGoal.Response = await self._answer(self._handle.cancel_goal_async())
        return response

    async def __aenter__(self) -> AsyncGoalHandle:
        await self.open()
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        await self.close(wait=True)

    # For the client

    async def open(self) -> None:
        """Send the goal, and wait until it is accepted."""
        client = self._client
        if client._is_destroyed:
            raise RuntimeError("Sending a goal with a destroyed action client is forbidden")
        self._driver.must_run(f"goal for {client._name}")
        client._goals[self] = None
        future = client._client.send_goal_async(self._goal, self._on_feedback, self._goal_uuid)
        try:
            self._handle = await self._answer(future)
        except asyncio.CancelledError:
            if not client._is_destroyed:
                await self._leave(self._driver.spawn(self._abandon(future)))
            self.drop()
            raise
        if not self._handle.accepted:
            self.drop()
            raise GoalRejectedError(f"the server of {client._name} did not accept the goal")
        # Asked for at once, so that the server cannot have forgotten it.
        self._result_future = self._handle.get_result_async()

    async def close(self, *, wait: bool) -> None:
        """Cancel the goal unless it has ended, and wait for its end if that is wanted."""
        future = self._result_future
        if future is not None and not future.done() and not self._client._is_destroyed:
            await self._leave(self._driver.spawn(self._cancel(wait=wait)))
        self.drop()

    def drop(self) -> None:
        """Wait for nothing any more."""
        self._client._goals.pop(self, None)
        for each in list(self._waiting):
            each.cancel()
        self._is_ended = True
        self._news.set()

    def end_feedback(self) -> None:
        """Note that all feedback is here, if the result is."""
        if self._result_future is not None and self._result_future.done():
            self._is_ended = True
            self._client._goals.pop(self, None)
            self._news.set()

    async def _answer(self, future: Future[Any]) -> Any:
        """Await a response, unless the client is destroyed."""
        follower = follow(future)
        self._waiting.add(follower)
        try:
            return await follower
        finally:
            self._waiting.discard(follower)

    async def _on_feedback(self, message: Any) -> None:
        self._feedback.append(message.feedback)
        self._news.set()
        if self._feedback_callback is not None:
            result = self._feedback_callback(message)
            if inspect.isawaitable(result):
                await result

    async def _leave(self, ending: asyncio.Task[Any]) -> None:
        """Wait for what ends the goal, as long as there is a server; it goes on if this is cancelled."""
        if not self._client.server_is_ready():
            return
        gone = self._driver.spawn(
            self._driver.sources.until(lambda: not self._client.server_is_ready(), interval=0.1)
        )
        try:
            await asyncio.wait((ending, gone), return_when=asyncio.FIRST_COMPLETED)
        finally:
            gone.cancel()

    async def _abandon(self, future: Future[ClientGoalHandle[Any]]) -> None:
        """Cancel a goal that nobody wants any more, once the server has accepted it."""
        handle = await wrap_future(future)
        if handle.accepted:
            await wrap_future(handle.cancel_goal_async())

    async def _cancel(self, *, wait: bool) -> None:
        assert self._result_future is not None
        response = await wrap_future(self._handle.cancel_goal_async())
        if response.goals_canceling or response.return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED:
            if wait:
                await wrap_future(self._result_future, give_up=False)
        elif not self._result_future.done():
            self._driver.node.get_logger().warning(
                f"the server of {self._client._name} refuses to cancel a goal, which goes on"
            )
