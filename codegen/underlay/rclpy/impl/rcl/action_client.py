"""The handle of an action client."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from rmw_local.message import DecodeError, message_type

from .action_entity import ActionEntity, states
from .handle import RCLError
from .services import Client
from .topics import Subscription

if TYPE_CHECKING:
    from .node import Node


class ActionClient(ActionEntity):
    """Three service clients and two subscriptions under the name of an action.

    Raises ValueError for a bad name or a context that is down, RuntimeError for what is no action.
    """

    _what = "action client"
    _empty_name = "Failed to create {what}: failed to get goal service name"

    def __init__(
        self,
        node: Node,
        pyaction_type: Any,
        action_name: str,
        goal_service_qos: object,
        result_service_qos: object,
        cancel_service_qos: object,
        feedback_topic_qos: object,
        status_topic_qos: object,
    ) -> None:
        super().__init__(node, pyaction_type, action_name)
        impl = pyaction_type.Impl
        self._goal: Client = self._own(Client, impl.SendGoalService, "send_goal", goal_service_qos)
        self._cancel: Client = self._own(Client, impl.CancelGoalService, "cancel_goal", cancel_service_qos)
        self._result: Client = self._own(Client, impl.GetResultService, "get_result", result_service_qos)
        self._feedback: Subscription = self._own(
            Subscription, impl.FeedbackMessage, "feedback", feedback_topic_qos
        )
        self._status: Subscription = self._own(
            Subscription, impl.GoalStatusMessage, "status", status_topic_qos
        )
        self._status_type = message_type(impl.GoalStatusMessage)
        self._waited_for = [
            ("subscription", self._feedback),
            ("subscription", self._status),
            ("client", self._goal),
            ("client", self._cancel),
            ("client", self._result),
        ]

    def is_action_server_available(self) -> bool:
        """Whether all five parts have a counterpart that they match."""
        failure = "Failed to check if action server is available"
        if self._destroyed:
            raise RCLError(f"{failure}: rcl node pointer is invalid")
        if not self._node.context.valid:
            raise RCLError(f"{failure}: rcl node's context is invalid")
        return all(
            client.service_server_is_available() for client in (self._goal, self._cancel, self._result)
        ) and all(topic.get_publisher_count() for topic in (self._feedback, self._status))

    def send_goal_request(self, pyrequest: Any) -> int:
        """Ask the server to accept a goal; return the request's number."""
        self._must_live("Failed to send goal request")
        return self._goal.send_request(pyrequest)

    def send_cancel_request(self, pyrequest: Any) -> int:
        """Ask the server to cancel goals; return the request's number."""
        self._must_live("Failed to send cancel request")
        return self._cancel.send_request(pyrequest, expects_server=True)

    def send_result_request(self, pyrequest: Any) -> int:
        """Ask the server for the result of a goal; return the request's number."""
        self._must_live("Failed to send result request")
        return self._result.send_request(pyrequest, expects_server=True)

    def take_goal_response(self, pymsg_type: type[Any]) -> tuple[int | None, Any]:
        """Take (number of the request, response or failure); (None, None) if there is none."""
        self._must_live("Failed to take goal")
        return _take_response(self._goal, pymsg_type)

    def take_cancel_response(self, pymsg_type: type[Any]) -> tuple[int | None, Any]:
        """Take (number of the request, response or failure); (None, None) if there is none."""
        self._must_live("Failed to take cancel")
        return _take_response(self._cancel, pymsg_type)

    def take_result_response(self, pymsg_type: type[Any]) -> tuple[int | None, Any]:
        """Take (number of the request, response or failure); (None, None) if there is none."""
        self._must_live("Failed to take result")
        return _take_response(self._result, pymsg_type)

    def take_feedback(self, pymsg_type: type[Any]) -> Any:
        """Take a feedback message; None if there is none."""
        self._must_live("Failed to take feedback with an action client")
        return _take_message(self._feedback, pymsg_type)

    def take_status(self, pymsg_type: type[Any]) -> Any:
        """Take a status array; None if there is none."""
        self._must_live("Failed to take status with an action client")
        return _take_message(self._status, pymsg_type)

    def take_serialized_status(self) -> bytes | None:
        """Take a status array as it was sent; None if there is none."""
        self._must_live("Failed to take status with an action client")
        taken = self._status.take(raw=True)
        return None if taken is None else taken[0]

    def states(self, serialized_status: bytes, goals: Collection[bytes]) -> dict[bytes, int]:
        """The states of the given goals in a status array, by id; none if it is unreadable."""
        try:
            return states(serialized_status, goals, self._status_type)
        except DecodeError:
            self._status_type.drops.add()
            return {}


def _take_response(client: Client, pymsg_type: type[Any]) -> tuple[int | None, Any]:
    header, response = client.take_response(pymsg_type)
    if header is None:
        header, response = client.take_failure()
    return (None, None) if header is None else (header.request_id.sequence_number, response)


def _take_message(subscription: Subscription, pymsg_type: type[Any]) -> Any:
    taken = subscription.take(raw=False)
    return None if taken is None else taken[0]
