"""The handle of an action server."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from .action_entity import ActionEntity, Goal, GoalEvent, StatusArray, key_of
from .clock import Clock, Timer
from .handle import RCLError
from .services import Service
from .structs import rmw_request_id_t
from .topics import Publisher

if TYPE_CHECKING:
    from .node import Node

# The return codes of action_msgs/srv/CancelGoal that a server decides on by itself.
_ERROR_NONE, _ERROR_UNKNOWN_GOAL_ID, _ERROR_GOAL_TERMINATED = 0, 2, 3

_LONGEST_TIMEOUT = 2**63 / 1e9  # [s]


class ActionServer(ActionEntity):
    """Three services and two publishers under the name of an action, and the goals that were accepted.

    A goal that has ended is kept for `result_timeout` [s] of `clock`. Raises ValueError for a bad name,
    a negative timeout or a context that is down, RuntimeError for what is no action.

    Its lock comes before the middleware's: it is held while statuses are published and the timer is set.
    """

    _what = "action server"
    _bad_name = _empty_name = "Failed to create {what} due to invalid topic name '{name}' : : {reason}"

    def __init__(
        self,
        node: Node,
        rclpy_clock: Clock,
        pyaction_type: Any,
        action_name: str,
        goal_service_qos: object,
        result_service_qos: object,
        cancel_service_qos: object,
        feedback_topic_qos: object,
        status_topic_qos: object,
        result_timeout: float,
    ) -> None:
        super().__init__(node, pyaction_type, action_name)
        self._clock = rclpy_clock
        self._timeout = _timeout_ns(result_timeout)
        self._lock = threading.Lock()
        self._goals: dict[bytes, Goal] = {}  # by id, in order of acceptance
        self._statuses = StatusArray()  # of these
        self._ended: deque[Goal] = deque()  # those in a terminal state, in order of their ends
        impl = pyaction_type.Impl
        self._goal: Service = self._own(Service, impl.SendGoalService, "send_goal", goal_service_qos)
        self._cancel: Service = self._own(Service, impl.CancelGoalService, "cancel_goal", cancel_service_qos)
        self._result: Service = self._own(Service, impl.GetResultService, "get_result", result_service_qos)
        self._feedback: Publisher = self._own(Publisher, impl.FeedbackMessage, "feedback", feedback_topic_qos)
        self._status: Publisher = self._own(Publisher, impl.GoalStatusMessage, "status", status_topic_qos)
        self._expiry = Timer(rclpy_clock, node.context, self._timeout, autostart=False)
        self._parts.append(self._expiry)
        self._waited_for = [
            ("service", self._goal),
            ("service", self._cancel),
            ("service", self._result),
            ("timer", self._expiry),
        ]

    # Requests and responses

    def take_goal_request(self, pymsg_type: type[Any]) -> tuple[rmw_request_id_t | None, Any]:
        """Take (header, request); (None, None) if there is none."""
        self._must_live("Failed to take goal")
        return _take_request(self._goal, pymsg_type)

    def take_cancel_request(self, pymsg_type: type[Any]) -> tuple[rmw_request_id_t | None, Any]:
        """Take (header, request); (None, None) if there is none."""
        self._must_live("Failed to take cancel")
        return _take_request(self._cancel, pymsg_type)

    def take_result_request(self, pymsg_type: type[Any]) -> tuple[rmw_request_id_t | None, Any]:
        """Take (header, request); (None, None) if there is none."""
        self._must_live("Failed to take result")
        return _take_request(self._result, pymsg_type)

    def send_goal_response(self, header: object, pyresponse: Any) -> None:
        """Answer whether a goal is accepted."""
        self._must_live("Failed to send goal response")
        _send_response(self._goal, header, pyresponse)

    def send_cancel_response(self, header: object, pyresponse: Any) -> None:
        """Answer which goals will be cancelled."""
        self._must_live("Failed to send cancel response")
        _send_response(self._cancel, header, pyresponse)

    def send_result_response(self, header: object, pyresponse: Any) -> None:
        """Answer with a result."""
        self._must_live("Failed to send result response")
        _send_response(self._result, header, pyresponse)

    # Goals

    def goal_exists(self, pygoal_info: Any) -> bool:
        """Whether a goal with this id was accepted and its result has not expired."""
        return not self._destroyed and key_of(pygoal_info.goal_id) in self._goals

    def accept(self, goal_info: Any) -> Goal:
        """Know a goal from now on; raises RCLError if its id is known. For ActionGoalHandle."""
        self._must_work("Failed to accept new goal")
        uuid = key_of(goal_info.goal_id)
        with self._lock:
            if uuid in self._goals:
                raise RCLError("Failed to accept new goal: goal ID already exists")
            goal = self._goals[uuid] = Goal(uuid, self._clock.now_ns())
            self._statuses.add(uuid, goal.accepted_ns, goal.state)
        return goal

    def advance(self, goal: Goal, event: GoalEvent) -> None:
        """Change a goal's state; raises RCLError if the event may not happen in it. For ActionGoalHandle."""
        with self._lock:
            goal.advance(event)
            if self._goals.get(goal.uuid) is goal:
                self._statuses.change(goal.uuid, goal.state)
            if not goal.is_active:
                goal.ended_ns = self._clock.now_ns()
                self._ended.append(goal)

    def forget(self, goal: Goal) -> None:
        """Know a goal no longer. For ActionGoalHandle."""
        with self._lock:
            self._drop(goal)

    def notify_goal_done(self) -> None:
        """Let the results of goals that have ended expire in time."""
        self._must_work("Failed to notfiy action server of goal done")  # sic: what programs see
        with self._lock:
            if self._expiry.is_timer_canceled():
                self._schedule_expiry()

    def expire_goals(self, max_num_goals: int) -> tuple[Any, ...]:
        """Forget at most `max_num_goals` expired goals; return their action_msgs/msg/GoalInfo."""
        self._must_live("Failed to expire goals")
        if max_num_goals <= 0:
            raise RCLError(
                "Failed to expire goals: expired_goals, expired_goals_capacity, and num_expired inconsistent"
            )
        expired: list[Any] = []
        with self._lock:
            born_after = self._clock.now_ns() - self._timeout
            while self._ended and len(expired) < max_num_goals and self._ended[0].ended_ns <= born_after:
                goal = self._ended.popleft()
                if self._drop(goal):
                    expired.append(_goal_info(goal))
            self._schedule_expiry()
        return tuple(expired)

    def process_cancel_request(self, pycancel_request: Any, pycancel_response_type: type[Any]) -> Any:
        """Make the response that lists the goals to cancel; what becomes of them is up to the caller.

        Zero id and zero stamp mean all goals; only an id that goal; otherwise all that were accepted at the
        stamp or before, and the one with the id.
        """
        if self._destroyed:
            raise RuntimeError("Failed to process cancel request: action server pointer is invalid")
        info = pycancel_request.goal_info
        uuid = key_of(info.goal_id)
        until = info.stamp.sec * 1_000_000_000 + info.stamp.nanosec
        response = pycancel_response_type()
        with self._lock:
            if any(uuid) and not until:
                found = self._goals.get(uuid)
                response.return_code = _code_for(found)
                chosen = [] if found is None else [found]
            else:
                response.return_code = _ERROR_NONE
                every = not until  # and no id
                chosen = [
                    goal
                    for goal in self._goals.values()
                    if every or goal.accepted_ns <= until or goal.uuid == uuid
                ]
            response.goals_canceling = [_goal_info(goal) for goal in chosen if goal.is_cancelable]
        return response

    # Topics

    def publish_feedback(self, pymsg: Any) -> None:
        """Publish what is to be known of a goal on its way."""
        self._must_work("Failed to publish feedback with an action server")
        self._feedback.publish(pymsg)

    def publish_status(self) -> None:
        """Publish the states of all goals."""
        self._must_work("Failed get goal status array")  # sic
        # Under the lock, or an older array could overtake a newer one and stay the last for ever.
        with self._lock:
            self._status.publish_serialized(self._statuses.to_bytes())

    def _must_work(self, failure: str) -> None:
        if self._destroyed or not self._node.context.valid:
            self._must_live(failure)
            raise RCLError(f"{failure}: feedback publisher is invalid")

    def _drop(self, goal: Goal) -> bool:
        """Forget a goal, but no other that has its id by now."""
        if self._goals.get(goal.uuid) is not goal:
            return False
        del self._goals[goal.uuid]
        self._statuses.remove(goal.uuid)
        return True

    def _schedule_expiry(self) -> None:
        """Set the timer to when the first of the ended goals expires. Called with the lock held."""
        if self._ended:
            left = self._ended[0].ended_ns + self._timeout - self._clock.now_ns()
            self._expiry.change_timer_period(max(left, 0))
            self._expiry.reset_timer()
        else:
            self._expiry.cancel_timer()


def _goal_info(goal: Goal) -> Any:
    from action_msgs.msg import GoalInfo  # late: most programs have no actions

    info = GoalInfo()
    info.goal_id.uuid = list(goal.uuid)
    info.stamp.sec, info.stamp.nanosec = divmod(goal.accepted_ns, 1_000_000_000)
    return info


def _code_for(goal: Goal | None) -> int:
    if goal is None:
        return _ERROR_UNKNOWN_GOAL_ID
    return _ERROR_NONE if goal.is_cancelable else _ERROR_GOAL_TERMINATED


def _timeout_ns(seconds: object) -> int:
    if not isinstance(seconds, int | float):
        raise TypeError(f"ActionServer(): expected result_timeout in seconds, got {seconds!r}")
    if not 0 <= seconds < _LONGEST_TIMEOUT:
        raise ValueError("Failed to create action server: timer period must be non-negative")
    return int(seconds * 1e9)


def _take_request(service: Service, pymsg_type: type[Any]) -> tuple[rmw_request_id_t | None, Any]:
    request, header = service.service_take_request(pymsg_type)
    return (None, None) if header is None else (header.request_id, request)


def _send_response(service: Service, header: object, pyresponse: Any) -> None:
    if not isinstance(header, rmw_request_id_t):
        raise TypeError(f"expected the header of a request (rmw_request_id_t), got {header!r}")
    service.service_send_response(pyresponse, header)
