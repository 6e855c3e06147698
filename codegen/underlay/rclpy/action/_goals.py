"""Goals, as the client that sent them and the server that accepted them see them, and waiting for them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus

from rclpy.exceptions import InvalidHandle
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import wrong_class
from rclpy.impl.typed import ActionT_co, Generic
from rclpy.waitable import NumberOfEntities, Waitable

if TYPE_CHECKING:
    from action_msgs.msg import GoalInfo
    from action_msgs.srv import CancelGoal
    from builtin_interfaces.msg import Time
    from unique_identifier_msgs.msg import UUID

    from rclpy.action.client import ActionClient
    from rclpy.action.server import ActionServer
    from rclpy.callback_groups import CallbackGroup
    from rclpy.impl.typed import Action, FeedbackT, GoalT, ResponseT, ResultT, Service
    from rclpy.task import Future


class ActionWaitable(Waitable):
    """Waits for the parts of one handle, and takes one thing of each part that was found ready."""

    def __init__(self, callback_group: CallbackGroup) -> None:
        super().__init__(callback_group)
        self._waited_for: _rclpy.ActionClient | _rclpy.ActionServer
        self._ready: Sequence[bool] = ()  # what was found last, in the handle's order

    def _wait_for(self, handle: _rclpy.ActionClient | _rclpy.ActionServer) -> None:
        """Wait for this handle from now on."""
        self._waited_for = handle
        self._fixed_handles = handle.handles

    def is_ready(self, wait_set: _rclpy.WaitSet) -> bool:
        """Return whether something of this is ready in the wait set."""
        self._ready = self._waited_for.is_ready(wait_set)
        return any(self._ready)

    def _find_ready(self) -> bool:
        """Look for ready parts of the action."""
        self._ready = ready = [handle.is_ready() for handle in self._fixed_handles]
        return True in ready and not self._waited_for._destruction_requested

    def take_data(self) -> dict[str, Any]:
        """Take one of each kind that was found ready, and return them by kind."""
        try:
            with self._waited_for:
                return self._take_ready()
        except InvalidHandle:  # destroyed since it was found ready
            return {}

    def _take_ready(self) -> dict[str, Any]:
        raise NotImplementedError

    def get_num_entities(self) -> NumberOfEntities:
        """Return how many entities of each kind this adds to a wait set."""
        return NumberOfEntities(*self._waited_for.get_num_entities())

    def add_to_wait_set(self, wait_set: _rclpy.WaitSet) -> None:
        """Add the entities to a wait set."""
        self._waited_for.add_to_waitset(wait_set)

    def __enter__(self) -> None:
        self._waited_for.__enter__()

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self._waited_for.__exit__(t, v, tb)


class ClientGoalHandle(Generic[ActionT_co]):
    """A goal that a server has answered to; what `send_goal_async` results in."""

    def __init__(self, action_client: ActionClient[ActionT_co], goal_id: UUID, goal_response: Any) -> None:
        self._action_client = action_client
        self._goal_id = goal_id
        self._goal_response = goal_response
        self._status: int = GoalStatus.STATUS_UNKNOWN

    def __eq__(self, other: Any) -> bool:
        equal: bool = self._goal_id == other.goal_id
        return equal

    def __ne__(self, other: Any) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment]  # handles are compared by value, as upstream's are

    def __repr__(self) -> str:
        return f"ClientGoalHandle <id={self.goal_id.uuid}, accepted={self.accepted}, status={self.status}>"

    @property
    def goal_id(self) -> UUID:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._goal_id

    @property
    def stamp(self) -> Time:
        """The time when the server accepted the goal; zero if it rejected it."""
        stamp: Time = self._goal_response.stamp
        return stamp

    @property
    def accepted(self) -> bool:
        """Whether the server accepted the goal."""
        accepted: bool = self._goal_response.accepted
        return accepted

    @property
    def status(self) -> int:
        """The state that the server last published, a value of action_msgs/msg/GoalStatus; 0 before that."""
        return self._status

    def cancel_goal(self) -> CancelGoal.Response:
        """Ask for the goal to be cancelled and wait for the response (action_msgs/srv/CancelGoal).

        Another thread has to spin. Not for callbacks, because nothing would receive the response there.
        """
        return self._action_client._cancel_goal(self)

    def cancel_goal_async(self) -> Future[CancelGoal.Response]:
        """Ask for the goal to be cancelled; the future completes with the response."""
        return self._action_client._cancel_goal_async(self)

    def get_result(
        self: ClientGoalHandle[Action[Any, Any, Any, Any, Service[Any, ResponseT]]],
    ) -> ResponseT:
        """Ask for the result and wait until the goal has ended; the response has `status` and `result`.

        Another thread has to spin. Not for callbacks, because nothing would receive the response there.
        """
        response: ResponseT = self._action_client._get_result(self)
        return response

    def get_result_async(
        self: ClientGoalHandle[Action[Any, Any, Any, Any, Service[Any, ResponseT]]],
    ) -> Future[ResponseT]:
        """Ask for the result; the future completes, when the goal has ended, with `status` and `result`."""
        return self._action_client._get_result_async(self)


class ServerGoalHandle(Generic[ActionT_co]):
    """A goal that the server has accepted; what execute callbacks work with.

    :raises RuntimeError: if the server knows a goal of this id.
    """

    def __init__(
        self, action_server: ActionServer[ActionT_co], goal_info: GoalInfo, goal_request: Any
    ) -> None:
        handle = _rclpy.ActionGoalHandle(action_server._handle, goal_info)
        self._goal_handle: _rclpy.ActionGoalHandle | None = handle  # None once it is destroyed
        self._action_server = action_server
        self._goal_info = goal_info
        self._goal_request = goal_request
        self._has_callback = False  # whose return value is the result; else it is set when the goal ends
        # A state and its publication belong together. Comes before the lock of the server's handle.
        self._lock = threading.Lock()

    def __eq__(self, other: Any) -> bool:
        equal: bool = self.goal_id == other.goal_id
        return equal

    def __ne__(self, other: Any) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment]  # handles are compared by value, as upstream's are

    @property
    def request(self: ServerGoalHandle[Action[GoalT, Any, Any, Any, Any]]) -> GoalT:
        """The goal, of the action's Goal class."""
        goal: GoalT = self._goal_request
        return goal

    @property
    def goal_id(self) -> UUID:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._goal_info.goal_id

    @property
    def is_active(self) -> bool:
        """Whether the goal is accepted, executing or being cancelled."""
        with self._lock:
            return self._goal_handle is not None and self._goal_handle.is_active()

    @property
    def is_cancel_requested(self) -> bool:
        """Whether the goal is being cancelled: a request was accepted, and `canceled` not yet called."""
        return self.status == GoalStatus.STATUS_CANCELING

    @property
    def status(self) -> int:
        """The state, a value of action_msgs/msg/GoalStatus; 0 after `destroy`."""
        with self._lock:
            if self._goal_handle is None:
                unknown: int = GoalStatus.STATUS_UNKNOWN
                return unknown
            return self._goal_handle.get_status()

    def _update_state(self, event: _rclpy.GoalEvent) -> None:
        with self._lock:
            if self._goal_handle is None:
                return
            self._goal_handle.update_goal_state(event)
            self._action_server._publish_status()
            if not self._goal_handle.is_active():
                try:
                    self._action_server.notify_goal_done()
                except _rclpy.RCLError:
                    if self._action_server._handle.pointer:
                        raise  # else another thread has destroyed the server

    def execute(self, execute_callback: Callable[[ServerGoalHandle[ActionT_co]], Any] | None = None) -> None:
        """Let the executor run a callback (None: the server's own), also if the goal is being cancelled.

        Without any callback, the program ends the goal itself.

        :raises RCLError: if the goal executes already or has ended.
        """
        if not self.is_cancel_requested:
            if distro.follows("second_execute") and self.status != GoalStatus.STATUS_ACCEPTED:
                return
            self._update_state(_rclpy.GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def executing(self) -> None:
        """Let the goal execute without a callback; raises RCLError if it executes already or has ended."""
        distro.uses("executing")
        self._update_state(_rclpy.GoalEvent.EXECUTE)

    def publish_feedback(
        self: ServerGoalHandle[Action[Any, Any, FeedbackT, Any, Any]], feedback: FeedbackT
    ) -> None:
        """Publish feedback about this goal.

        :raises TypeError: if it is not of the action's Feedback class.
        """
        action_type = self._action_server.action_type
        if not isinstance(feedback, action_type.Feedback):
            raise wrong_class(feedback, action_type.Feedback)
        if distro.follows("late_feedback") and self.status != GoalStatus.STATUS_EXECUTING:
            self._action_server._logger.warning("Feedback of a goal that does not execute is dropped")
            return
        with self._lock:
            if self._goal_handle is None:
                return
            message = action_type.Impl.FeedbackMessage(goal_id=self.goal_id, feedback=feedback)
            self._action_server._publish_feedback(message)

    # With a response, the three ways to end a goal set its result. Otherwise that is the return value of the
    # execute callback, or an empty one if none was called. Any thread may call them.

    def succeed(
        self: ServerGoalHandle[Action[Any, ResultT, Any, Any, Any]], response: ResultT | None = None
    ) -> None:
        """End the goal as succeeded; raises RCLError unless it executes or is being cancelled."""
        self._end(_rclpy.GoalEvent.SUCCEED, response)

    def abort(
        self: ServerGoalHandle[Action[Any, ResultT, Any, Any, Any]], response: ResultT | None = None
    ) -> None:
        """End the goal as aborted; raises RCLError unless it executes or is being cancelled."""
        self._end(_rclpy.GoalEvent.ABORT, response)

    def canceled(
        self: ServerGoalHandle[Action[Any, ResultT, Any, Any, Any]], response: ResultT | None = None
    ) -> None:
        """End the goal as cancelled; raises RCLError unless it is being cancelled."""
        self._end(_rclpy.GoalEvent.CANCELED, response)

    def _end(self, event: _rclpy.GoalEvent, result: Any) -> None:
        server = self._action_server
        if result is not None and not isinstance(result, server.action_type.Result):
            raise wrong_class(result, server.action_type.Result)
        self._update_state(event)
        if result is not None or not self._has_callback:
            server._keep_result(self, server.action_type.Result() if result is None else result)

    def destroy(self) -> None:
        """Let the server forget the goal; what is done with the handle afterwards has no effect."""
        with self._lock:
            if self._goal_handle is None:
                return
            self._goal_handle.destroy_when_not_in_use()
            self._goal_handle = None
