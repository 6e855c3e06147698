"""Action servers: they accept goals, execute them, publish feedback and keep results."""

from __future__ import annotations

import functools
import traceback
from collections.abc import Callable
from contextlib import suppress
from enum import Enum
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus

from rclpy.action._goals import ActionWaitable
from rclpy.action._goals import ServerGoalHandle as ServerGoalHandle  # noqa: PLC0414 - programs import it from here
from rclpy.exceptions import InvalidHandle
from rclpy.executors import await_or_execute
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.logging_severity import LoggingSeverity as _LoggingSeverity
from rclpy.impl.messages import wrong_return
from rclpy.impl.rcl.action_entity import key_of
from rclpy.impl.rcutils_logger import RcutilsLogger as _RcutilsLogger
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import ActionT_co, Generic
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future
from rclpy.type_support import check_for_type_support

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.impl.typed import ActionClass, GoalT, MaybeAsync, ResultT
    from rclpy.node import Node
    from rclpy.service_introspection import ServiceIntrospectionState

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

ServerGoalHandle.__module__ = __name__  # where programs know it from

RCLError = _rclpy.RCLError
GoalEvent = _rclpy.GoalEvent

_RESULT_TIMEOUT = 10 if distro.follows("result_timeout") else 900  # [s]


class GoalResponse(Enum):
    """The answer of a goal callback."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """The answer of a cancel callback."""

    REJECT = 1
    ACCEPT = 2


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute the goal at once."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept every goal."""
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:
    """Let no goal be cancelled."""
    return CancelResponse.REJECT


class ActionServer(ActionWaitable, Generic[ActionT_co]):
    """Serves one action.

    Underneath are three services (send_goal, cancel_goal, get_result) and two publishers (feedback, status).

    :param node: the node it belongs to.
    :param action_type: the class of the action.
    :param action_name: its name; expanded, and remapped as a topic is.
    :param execute_callback: called with the ServerGoalHandle of a goal to execute; returns the Result.
        Without one, the program ends each goal by `succeed`, `abort` or `canceled`.
    :param callback_group: None for the node's default one. Execute callbacks are tasks and belong to none.
    :param goal_callback: called with a goal; returns a GoalResponse.
    :param handle_accepted_callback: called with a ServerGoalHandle afterwards; may defer `execute`.
    :param cancel_callback: called with the ServerGoalHandle of a goal to cancel; returns a CancelResponse.
    :param result_timeout: how long a result is kept after its goal has ended [s].
    :raises TypeError: if the execute callback cannot be called.
    :raises ValueError: for a bad name, a negative timeout, or after a shutdown.
    :raises AttributeError: if the type is no ROS interface.
    """

    def __init__(
        self,
        node: Node,
        action_type: ActionClass[ActionT_co, GoalT, ResultT],
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle[ActionT_co]], MaybeAsync[ResultT]] | None = None,
        *,
        callback_group: CallbackGroup | None = None,
        goal_callback: Callable[[GoalT], MaybeAsync[GoalResponse]] | None = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle[ActionT_co]], object]
        | None = default_handle_accepted_callback,
        cancel_callback: Callable[[ServerGoalHandle[ActionT_co]], MaybeAsync[CancelResponse]]
        | None = default_cancel_callback,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 - upstream's default
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = _RESULT_TIMEOUT,
    ) -> None:
        super().__init__(node.default_callback_group if callback_group is None else callback_group)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_goal_callback(goal_callback)
        self.register_cancel_callback(cancel_callback)
        self._execute_callback: Callable[[ServerGoalHandle[ActionT_co]], Any] | None = None
        if execute_callback is not None:
            self.register_execute_callback(execute_callback)

        check_for_type_support(action_type)
        self._node = node
        self._action_type: Any = action_type
        with node.handle, node.get_clock().handle:
            self._handle = _rclpy.ActionServer(
                node.handle,
                node.get_clock().handle,
                action_type,
                action_name,
                goal_service_qos_profile.get_c_qos_profile(),
                result_service_qos_profile.get_c_qos_profile(),
                cancel_service_qos_profile.get_c_qos_profile(),
                feedback_pub_qos_profile.get_c_qos_profile(),
                status_pub_qos_profile.get_c_qos_profile(),
                result_timeout,
            )
        self._wait_for(self._handle)
        # By id
        self._goal_handles: dict[bytes, ServerGoalHandle[ActionT_co]] = {}
        self._result_futures: dict[bytes, Future] = {}

        self._logger = node.get_logger().get_child("action_server")
        node.add_waitable(self)

    @property
    def action_type(self) -> Any:
        """The class of the action."""
        return self._action_type

    def _debug(self, text: str, *values: Any) -> None:
        """Log for debugging; ids are arrays, which are slow to print.

        A logger that somebody has put in its place gets everything.
        """
        if type(self._logger) is not _RcutilsLogger or self._logger.is_enabled_for(_LoggingSeverity.DEBUG):
            self._logger.debug(text.format(*values))

    # Requests

    async def _execute_goal_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        """Accept or reject a goal, and hand an accepted one over."""
        header, request = request_header_and_message
        goal_info = GoalInfo(goal_id=request.goal_id)
        goal_id = goal_info.goal_id.uuid
        self._debug("New goal request with ID: {0}", goal_id)
        goal_handle = fault = None
        try:
            if not self._handle.goal_exists(goal_info) and await self._is_welcome(request.goal):
                goal_handle = self._accept(goal_info, request.goal)
        except Exception as error:  # raised below: a client without an answer would wait for ever
            fault = error

        response = self._action_type.Impl.SendGoalService.Response(
            accepted=goal_handle is not None, stamp=goal_info.stamp
        )
        try:
            self._handle.send_goal_response(header, response)
        except RCLError:
            self._logger.warn("Failed to send goal response (the client may have gone away)")
            return
        if fault is not None:
            raise fault
        if goal_handle is None:
            self._debug("New goal rejected: {0}", goal_id)
            return
        self._debug("New goal accepted: {0}", goal_id)
        self._publish_status()
        try:
            await await_or_execute(self._handle_accepted_callback, goal_handle)
        except Exception:
            if goal_handle.status == GoalStatus.STATUS_ACCEPTED:  # nobody executes it now
                goal_handle._update_state(GoalEvent.EXECUTE)
                goal_handle.abort()
            raise

    def _aborted(self) -> Any:
        """A response without a result."""
        return self._action_type.Impl.GetResultService.Response(
            status=GoalStatus.STATUS_ABORTED, result=self._action_type.Result()
        )

    async def _is_welcome(self, goal: Any) -> bool:
        response = await await_or_execute(self._goal_callback, goal)
        if not isinstance(response, GoalResponse):
            self._logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
        return response is GoalResponse.ACCEPT

    def _accept(self, goal_info: Any, goal: Any) -> ServerGoalHandle[ActionT_co] | None:
        """Make the goal's handle and its result's future; None if the id was accepted in the meantime."""
        goal_info.stamp = self._node.get_clock().now().to_msg()
        try:
            goal_handle = ServerGoalHandle(self, goal_info, goal)
        except RuntimeError as error:
            self._logger.error(f"Failed to accept new goal with ID {goal_info.goal_id.uuid}: {error}")
            return None
        key = key_of(goal_info.goal_id)
        future = Future()
        self._goal_handles[key] = goal_handle
        self._result_futures[key] = future
        self.add_future(future)
        return goal_handle

    async def _execute_goal(
        self,
        execute_callback: Callable[[ServerGoalHandle[ActionT_co]], Any],
        goal_handle: ServerGoalHandle[ActionT_co],
    ) -> None:
        """Call the execute callback, see to it that the goal ends, and keep the result."""
        goal_id = goal_handle.goal_id
        # A goal may end, and expire, long before its callback returns. Pending requests are answered even
        # then.
        future = self._result_futures.get(key_of(goal_id)) or Future()
        self._debug("Executing goal with ID {0}", goal_id.uuid)
        try:
            result = await await_or_execute(execute_callback, goal_handle)
        except Exception as error:
            result = self._action_type.Result()
            self._logger.error(f"Error raised in execute callback: {error}")
            traceback.print_exc()
        is_usable = isinstance(result, self._action_type.Result)
        if not is_usable:
            fault = wrong_return(
                f"the execute callback of action '{self._handle.name}'", result, self._action_type.Result
            )
            self._logger.error(f"{fault}. The client gets an empty result with the status aborted")
        if not self._handle.pointer:
            self._logger.warning(
                f"action server '{self._handle.name}' was destroyed while it executed a goal: "
                "the result goes to nobody"
            )
        if goal_handle.is_active:
            if is_usable:
                self._logger.warning(f"Goal state not set, assuming aborted. Goal ID: {goal_id.uuid}")
            goal_handle.abort()
        self._debug("Goal with ID {0} finished with state {1}", goal_id.uuid, goal_handle.status)

        if is_usable:
            response = self._action_type.Impl.GetResultService.Response(
                status=goal_handle.status, result=result
            )
        else:
            response = self._aborted()
        self._conclude(future, response)

    def _conclude(self, future: Future, response: Any) -> None:
        """Keep the response to those who ask for the result of a goal, unless there is one already."""
        if not future.done():
            future.set_result(response)
        with suppress(ValueError):  # the goal has expired, or the server is destroyed
            self.remove_future(future)  # it is kept for a while, and executors look at every future there is

    async def _execute_cancel_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        """Ask about each goal that is to be cancelled, and answer which of them will be."""
        header, request = request_header_and_message
        self._debug("Cancel request received: {0}", request)
        response = self._handle.process_cancel_request(
            request, self._action_type.Impl.CancelGoalService.Response
        )
        fault, asked, response.goals_canceling = None, response.goals_canceling, []
        for goal_info in asked:
            try:
                if await self._cancel(goal_info):
                    response.goals_canceling.append(goal_info)
            except Exception as error:  # raised below: a client without an answer would wait for ever
                fault = error
        try:
            self._handle.send_cancel_response(header, response)
        except RCLError:
            self._logger.warn("Failed to send cancel response (the client may have gone away)")
        if fault is not None:
            raise fault

    async def _cancel(self, goal_info: Any) -> bool:
        goal_handle = self._goal_handles.get(key_of(goal_info.goal_id))
        if goal_handle is None:
            return False
        answer = await await_or_execute(self._cancel_callback, goal_handle)
        if not isinstance(answer, CancelResponse):
            name = f"the cancel callback of action '{self._handle.name}'"
            self._logger.warning(f"{wrong_return(name, answer, CancelResponse)}. The goal is not cancelled")
        if answer is not CancelResponse.ACCEPT:
            return False
        try:
            goal_handle._update_state(GoalEvent.CANCEL_GOAL)
        except RCLError as error:  # the goal has ended while the callback ran
            self._debug("Failed to cancel goal in cancel callback: {0}", error)
            return False
        return True

    async def _execute_get_result_request(self, request_header_and_message: tuple[Any, Any]) -> None:
        """Answer now for a goal that is unknown, otherwise as soon as its result is there."""
        header, request = request_header_and_message
        goal_id = request.goal_id
        self._debug("Result request received for goal with ID: {0}", goal_id.uuid)
        future = self._result_futures.get(key_of(goal_id))
        if future is not None:
            future.add_done_callback(functools.partial(self._send_result_response, header))
            return
        self._debug("Sending result response for unknown goal ID: {0}", goal_id.uuid)
        response = self._action_type.Impl.GetResultService.Response()
        response.status = GoalStatus.STATUS_UNKNOWN
        self._handle.send_result_response(header, response)

    def _send_result_response(self, request_header: Any, future: Future) -> None:
        try:
            self._handle.send_result_response(request_header, future.result())
        except RCLError:
            self._logger.warn("Failed to send result response (the client may have gone away)")

    async def _execute_expire_goals(self, expired_goals: tuple[Any, ...]) -> None:
        """Forget goals whose results were kept long enough."""
        for goal_info in expired_goals:
            key = key_of(goal_info.goal_id)
            self._goal_handles.pop(key).destroy()
            del self._result_futures[key]

    # For executors

    def _take_ready(self) -> dict[str, Any]:
        """Take what is ready, by kind: `goal`, `cancel`, `result` and `expired`."""
        handle, impl = self._handle, self._action_type.Impl
        goal, cancel, result, expired = self._ready
        data: dict[str, Any] = {}
        # Another thread may be faster: then there is nothing to take.
        if goal and (taken := handle.take_goal_request(impl.SendGoalService.Request))[1] is not None:
            data["goal"] = taken
        if cancel and (taken := handle.take_cancel_request(impl.CancelGoalService.Request))[1] is not None:
            data["cancel"] = taken
        if result and (taken := handle.take_result_request(impl.GetResultService.Request))[1] is not None:
            data["result"] = taken
        if expired:
            data["expired"] = handle.expire_goals(max(len(self._goal_handles), 1))
        return data

    async def execute(self, taken_data: dict[str, Any]) -> None:
        """Answer requests, call the goal, accepted and cancel callbacks, forget goals that have expired."""
        try:
            if "goal" in taken_data:
                await self._execute_goal_request(taken_data["goal"])
            if "cancel" in taken_data:
                await self._execute_cancel_request(taken_data["cancel"])
            if "result" in taken_data:
                await self._execute_get_result_request(taken_data["result"])
            if "expired" in taken_data:
                await self._execute_expire_goals(taken_data["expired"])
        except (RCLError, InvalidHandle):
            if self._handle.pointer:
                raise
            self._logger.warning(f"action server '{self._handle.name}' was destroyed during a request")

    # For goal handles

    def notify_execute(
        self,
        goal_handle: ServerGoalHandle[Any],
        execute_callback: Callable[[ServerGoalHandle[Any]], Any] | None,
    ) -> None:
        """Let the node's executor run a callback for a goal; None for the server's own, if there is one."""
        callback = self._execute_callback if execute_callback is None else execute_callback
        if callback is None:
            return
        goal_handle._has_callback = True
        executor: Any = self._node.executor
        executor.create_task(self._execute_goal, callback, goal_handle)

    def _keep_result(self, goal_handle: ServerGoalHandle[Any], result: Any) -> None:
        """Answer with this result to those who ask for that of a goal."""
        future = self._result_futures.get(key_of(goal_handle.goal_id))
        if future is not None:
            kind = self._action_type.Impl.GetResultService.Response
            self._conclude(future, kind(status=goal_handle.status, result=result))

    def notify_goal_done(self) -> None:
        """Start the time after which results of goals that have ended expire."""
        self._handle.notify_goal_done()

    def _publish_status(self) -> None:
        """Publish the states of all goals."""
        try:
            self._handle.publish_status()
        except RCLError:
            if self._handle.pointer:
                raise  # else another thread has destroyed the server

    def _publish_feedback(self, message: Any) -> None:
        """Publish feedback about a goal."""
        try:
            self._handle.publish_feedback(message)
        except RCLError:
            if self._handle.pointer:
                raise  # else another thread has destroyed the server

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about the traffic of the three services, stamped with `clock`."""
        distro.uses("introspection")
        with self._handle:
            self._handle.configure_introspection(
                clock.handle, service_event_qos_profile.get_c_qos_profile(), introspection_state
            )

    # Callbacks

    def register_handle_accepted_callback(
        self, handle_accepted_callback: Callable[[ServerGoalHandle[ActionT_co]], object] | None
    ) -> None:
        """Call this with each accepted goal from now on; None: execute accepted goals at once."""
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], MaybeAsync[GoalResponse]] | None) -> None:
        """Ask this, which returns a GoalResponse, about each goal from now on; None: accept all."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_cancel_callback(
        self, cancel_callback: Callable[[ServerGoalHandle[ActionT_co]], MaybeAsync[CancelResponse]] | None
    ) -> None:
        """Ask this, which returns a CancelResponse, whether a goal may be cancelled; None: none may."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    def register_execute_callback(
        self, execute_callback: Callable[[ServerGoalHandle[ActionT_co]], Any]
    ) -> None:
        """Execute goals with this from now on; it returns the action's Result.

        :raises TypeError: if it cannot be called.
        """
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def destroy(self) -> None:
        """Destroy it and forget its goals; raises ValueError the second time."""
        for goal_handle in list(self._goal_handles.values()):
            goal_handle.destroy()
        self._futures.clear()
        self._handle.destroy_when_not_in_use()
        self._node.remove_waitable(self)
