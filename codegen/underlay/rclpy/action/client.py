"""Action clients: they send goals, hear feedback, ask for results and cancel."""

from __future__ import annotations

import threading
import uuid
import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus
from ifgen_runtime.errors import ServerGoneError
from rmw_local import timing
from unique_identifier_msgs.msg import UUID

from rclpy.action._goals import ActionWaitable
from rclpy.action._goals import ClientGoalHandle as ClientGoalHandle  # noqa: PLC0414 - programs import it from here
from rclpy.executors import await_or_execute
from rclpy.impl import blocking, distro
from rclpy.impl.blocking import wait_for_graph
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import wrong_class
from rclpy.impl.rcl.action_entity import key_of
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import ActionT_co, Generic
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future
from rclpy.type_support import check_for_type_support

if TYPE_CHECKING:
    from typing import TypedDict, Unpack

    from action_msgs.srv import CancelGoal

    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.impl.typed import Action, FeedbackMessageT, GoalT, ResponseT, Service, T
    from rclpy.node import Node
    from rclpy.service_introspection import ServiceIntrospectionState

    class _SendGoalOptions(TypedDict, Generic[FeedbackMessageT], total=False):
        feedback_callback: Callable[[FeedbackMessageT], object] | None
        goal_uuid: UUID | None


if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

ClientGoalHandle.__module__ = __name__  # where programs know it from

_TERMINAL = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)


class ActionClient(ActionWaitable, Generic[ActionT_co]):
    """Sends goals to the servers of one action.

    Underneath are three service clients (send_goal, cancel_goal, get_result) and two
    subscriptions (feedback, status).

    :param node: the node it belongs to.
    :param action_type: the class of the action.
    :param action_name: its name; expanded, and remapped as a topic is.
    :param callback_group: None for the node's default one.
    :raises ValueError: for a bad name, or after a shutdown.
    :raises AttributeError: if the type is no ROS interface.
    """

    def __init__(
        self,
        node: Node,
        action_type: type[ActionT_co],
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 - immutable in effect; upstream's default
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
        enable_feedback_msg_optimization: bool = False,
    ) -> None:
        if enable_feedback_msg_optimization:  # it changes nothing that a program can see
            distro.uses("feedback_filter")
        super().__init__(node.default_callback_group if callback_group is None else callback_group)
        check_for_type_support(action_type)
        self._node = node
        self._action_type: Any = action_type
        self._action_name = action_name
        with node.handle:
            self._client_handle = _rclpy.ActionClient(
                node.handle,
                action_type,
                action_name,
                goal_service_qos_profile.get_c_qos_profile(),
                result_service_qos_profile.get_c_qos_profile(),
                cancel_service_qos_profile.get_c_qos_profile(),
                feedback_sub_qos_profile.get_c_qos_profile(),
                status_sub_qos_profile.get_c_qos_profile(),
            )
        self._wait_for(self._client_handle)
        # No response may be looked at before its request is noted. Comes before the middleware's locks.
        self._lock = threading.Lock()
        # Goals, by id
        self._goal_handles: dict[bytes, weakref.ref[ClientGoalHandle[ActionT_co]]] = {}
        self._feedback_callbacks: dict[bytes, Callable[[Any], Any]] = {}
        # Requests, by number
        self._pending_goal_requests: dict[int, Future] = {}
        self._pending_cancel_requests: dict[int, Future] = {}
        self._pending_result_requests: dict[int, Future] = {}
        self._goal_sequence_number_to_goal_id: dict[int, Any] = {}
        self._result_sequence_number_to_goal_id: dict[int, Any] = {}

        self._logger = node.get_logger().get_child("action_client")
        node.add_waitable(self)

    # Goals

    def send_goal(
        self: ActionClient[Action[GoalT, Any, Any, FeedbackMessageT, Service[Any, ResponseT]]],
        goal: GoalT,
        **kwargs: Unpack[_SendGoalOptions[FeedbackMessageT]],
    ) -> ResponseT:
        """Send a goal and wait until it has ended; returns a response with `status` and `result`.

        Another thread has to spin. Not for callbacks, because nothing would receive the responses there.

        :param kwargs: as for `send_goal_async`.
        :raises TypeError: if the goal is not of the action's Goal class.
        """
        self._must_be_answerable("client.send_goal_async(goal)")
        response: ResponseT = self._get_result(_wait_for(self.send_goal_async(goal, **kwargs)))
        return response

    def send_goal_async(
        self: ActionClient[Action[GoalT, Any, Any, FeedbackMessageT, Any]],
        goal: GoalT,
        feedback_callback: Callable[[FeedbackMessageT], object] | None = None,
        goal_uuid: UUID | None = None,
    ) -> Future[ClientGoalHandle[ActionT_co]]:
        """Send a goal; the future completes with a ClientGoalHandle once a server has answered.

        :param feedback_callback: called with each feedback message (`goal_id`, `feedback`) about the goal,
            which may come before the future completes; may be a coroutine function.
        :param goal_uuid: the id (unique_identifier_msgs/msg/UUID); None for a random one.
        :raises TypeError: if the goal is not of the action's Goal class.
        :raises AttributeError: if the id is not a UUID.
        """
        if not isinstance(goal, self._action_type.Goal):
            raise wrong_class(goal, self._action_type.Goal)
        goal_id = self._generate_random_uuid() if goal_uuid is None else goal_uuid
        key = key_of(goal_id)
        request = self._action_type.Impl.SendGoalService.Request(goal_id=goal_id, goal=goal)
        with self._lock:
            number = self._client_handle.send_goal_request(request)
            future = self._expect(
                number, "goal", self._pending_goal_requests, self._remove_pending_goal_request
            )
            self._goal_sequence_number_to_goal_id[number] = goal_id
            if feedback_callback is not None:
                self._feedback_callbacks[key] = feedback_callback
        return future

    def _generate_random_uuid(self) -> Any:
        return UUID(uuid=bytearray(uuid.uuid4().bytes))

    def _cancel_goal(self, goal_handle: ClientGoalHandle[Any]) -> CancelGoal.Response:
        """Cancel a goal for ClientGoalHandle.cancel_goal."""
        self._must_be_answerable("goal_handle.cancel_goal_async()")
        return _wait_for(self._cancel_goal_async(goal_handle))

    def _cancel_goal_async(self, goal_handle: ClientGoalHandle[Any]) -> Future[CancelGoal.Response]:
        """Cancel a goal for ClientGoalHandle.cancel_goal_async."""
        _must_be_goal_handle(goal_handle)
        request = self._action_type.Impl.CancelGoalService.Request()
        request.goal_info.goal_id = goal_handle.goal_id
        with self._lock:
            number = self._client_handle.send_cancel_request(request)
            return self._expect(
                number, "cancel", self._pending_cancel_requests, self._remove_pending_cancel_request
            )

    def _get_result(self, goal_handle: ClientGoalHandle[Any]) -> Any:
        """Ask for the result of a goal for ClientGoalHandle.get_result."""
        self._must_be_answerable("goal_handle.get_result_async()")
        return _wait_for(self._get_result_async(goal_handle))

    def _get_result_async(self, goal_handle: ClientGoalHandle[Any]) -> Future[Any]:
        """Ask for the result of a goal for ClientGoalHandle.get_result_async."""
        _must_be_goal_handle(goal_handle)
        request = self._action_type.Impl.GetResultService.Request(goal_id=goal_handle.goal_id)
        with self._lock:
            number = self._client_handle.send_result_request(request)
            future = self._expect(
                number, "result", self._pending_result_requests, self._remove_pending_result_request
            )
            self._result_sequence_number_to_goal_id[number] = request.goal_id
        return future

    def _must_be_answerable(self, instead: str) -> None:
        """Raise, in strict mode, where waiting for a response would never end; see `blocking`."""
        if blocking.enabled:
            blocking.must_be_answerable(self, f"action '{self._action_name}'", instead)

    # Pending requests

    def _expect(
        self, number: int, kind: str, pending: dict[int, Future], forget: Callable[[Future], None]
    ) -> Future:
        """Make the future of a request that was just sent. Called with the lock held."""
        if number in pending:
            raise RuntimeError(f"Sequence ({number}) conflicts with pending {kind} request")
        future = pending[number] = Future()
        future.add_done_callback(forget)  # a program may give it up
        self.add_future(future)
        return future

    def _withdraw(
        self, number: int, pending: dict[int, Future], forget: Callable[[Future], None]
    ) -> Future | None:
        """Take the future of a request that was answered; None if that was not pending."""
        with self._lock:
            future = pending.pop(number, None)
        if future is not None:
            future.remove_done_callback(forget)
            self.remove_future(future)
        return future

    def _remove_pending_request(self, future: Future, pending_requests: dict[int, Future]) -> int | None:
        """Stop waiting for the response; returns the number of the request, None if it was not pending."""
        with self._lock:
            for number, pending in pending_requests.items():
                if pending is future:
                    del pending_requests[number]
                    break
            else:
                return None
        self.remove_future(future)
        return number

    def _remove_pending_goal_request(self, future: Future) -> None:
        number = self._remove_pending_request(future, self._pending_goal_requests)
        if number is not None:
            self._goal_sequence_number_to_goal_id.pop(number, None)

    def _remove_pending_cancel_request(self, future: Future) -> None:
        self._remove_pending_request(future, self._pending_cancel_requests)

    def _remove_pending_result_request(self, future: Future) -> None:
        number = self._remove_pending_request(future, self._pending_result_requests)
        if number is not None:
            self._end_feedback(number)

    def _end_feedback(self, result_number: int) -> None:
        """Call back no more for the goal whose result has been received or is not wanted any more."""
        goal_id = self._result_sequence_number_to_goal_id.pop(result_number, None)
        if goal_id is not None:
            self._feedback_callbacks.pop(key_of(goal_id), None)

    # For executors

    def _take_ready(self) -> dict[str, Any]:
        """Take what is ready, by kind: `goal`, `cancel`, `result`, `feedback` and `status`."""
        handle, impl = self._client_handle, self._action_type.Impl
        feedback, status, goal, cancel, result = self._ready
        data: dict[str, Any] = {}
        # Another thread may be faster: then there is nothing to take.
        if goal and (taken := handle.take_goal_response(impl.SendGoalService.Response))[1] is not None:
            data["goal"] = taken
        if cancel and (taken := handle.take_cancel_response(impl.CancelGoalService.Response))[1] is not None:
            data["cancel"] = taken
        if result and (taken := handle.take_result_response(impl.GetResultService.Response))[1] is not None:
            data["result"] = taken
        if feedback and (message := handle.take_feedback(impl.FeedbackMessage)) is not None:
            data["feedback"] = message
        if status and (status_array := handle.take_serialized_status()) is not None:
            data["status"] = status_array
        return data

    async def execute(self, taken_data: dict[str, Any]) -> None:
        """Complete futures, call the feedback callback and update goal handles."""
        if "goal" in taken_data:
            self._receive_goal_response(*taken_data["goal"])
        if "cancel" in taken_data:
            number, response = taken_data["cancel"]
            future = self._withdraw(
                number, self._pending_cancel_requests, self._remove_pending_cancel_request
            )
            self._complete(future, response, "cancel")
        if "result" in taken_data:
            number, response = taken_data["result"]
            future = self._withdraw(
                number, self._pending_result_requests, self._remove_pending_result_request
            )
            self._end_feedback(number)
            self._complete(future, response, "result")
        if "feedback" in taken_data:
            message = taken_data["feedback"]
            with self._lock:
                callback = self._feedback_callbacks.get(key_of(message.goal_id))
            if callback is not None:
                await await_or_execute(callback, message)
        if "status" in taken_data:
            self._receive_status(taken_data["status"])

    def _receive_goal_response(self, number: int, response: Any) -> None:
        future = self._withdraw(number, self._pending_goal_requests, self._remove_pending_goal_request)
        goal_id = self._goal_sequence_number_to_goal_id.pop(number, None)
        goal_handle: Any = None
        if type(response) is ServerGoneError:
            goal_handle = response
            self._feedback_callbacks.pop(key_of(goal_id), None)
        elif future is not None:
            goal_handle = ClientGoalHandle(self, goal_id, response)
            key = key_of(goal_id)
            if not goal_handle.accepted:
                self._feedback_callbacks.pop(key, None)
            elif key in self._goal_handles:
                raise RuntimeError(f"Two goals were accepted with the same ID ({goal_handle})")
            else:
                self._goal_handles[key] = weakref.ref(goal_handle)
        self._complete(future, goal_handle, "goal")

    def _complete(self, future: Future | None, value: Any, kind: str) -> None:
        if type(value) is ServerGoneError:
            if future is not None:
                future._fail(value)
        elif future is not None:
            future.set_result(value)
        else:
            self._logger.warning(
                f"Ignoring unexpected {kind} response. There may be more than "
                f"one action server for the action '{self._action_name}'"
            )

    def _receive_status(self, status_array: bytes) -> None:
        """Tell the goal handles that programs still hold."""
        for key, status in self._client_handle.states(status_array, list(self._goal_handles)).items():
            reference = self._goal_handles.get(key)
            goal_handle = None if reference is None else reference()
            if goal_handle is not None:
                goal_handle._status = status
            if goal_handle is None or status in _TERMINAL:
                self._goal_handles.pop(key, None)  # another thread may be at a later status array

    # The server

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Switch the events about the traffic of the three services, stamped with `clock`."""
        distro.uses("introspection")
        with self._client_handle:
            self._client_handle.configure_introspection(
                clock.handle, service_event_qos_profile.get_c_qos_profile(), introspection_state
            )

    def server_is_ready(self) -> bool:
        """Whether there is a server with all of its services and topics."""
        with self._node.handle:
            return self._client_handle.is_action_server_available()

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait until a server is there, at most `timeout_sec` seconds; returns whether it is.

        :raises RCLError: if the context is shut down.
        """
        timeout = None if timeout_sec is None else max(timeout_sec, 0.0)
        return wait_for_graph(self._node.handle, self.server_is_ready, timeout)

    def destroy(self) -> None:
        """Destroy it; raises ValueError the second time."""
        self._client_handle.destroy_when_not_in_use()
        self._node.remove_waitable(self)


def _must_be_goal_handle(goal_handle: object) -> None:
    if not isinstance(goal_handle, ClientGoalHandle):
        raise TypeError(f"Expected type ClientGoalHandle but received {type(goal_handle)}")


def _wait_for(future: Future[T]) -> T:
    """Wait until another thread has completed a future; returns the result or raises the exception."""
    done = timing.Event()
    future._wake_when_done(done.set)
    done.wait()
    return future.result()
