"""The shapes of the classes of interfaces, as newer ROS describes them in `rclpy.type_support`.

They are for annotations. No object is asked whether it has such a shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, TypeVar

from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time
from service_msgs.msg import ServiceEventInfo
from unique_identifier_msgs.msg import UUID


class PyCapsule(Protocol):
    """A pointer of C as Python holds it."""


class CommonMsgSrvMetaClass(Protocol):
    """The class of the class of a message or a service."""

    _TYPE_SUPPORT: PyCapsule | None

    @classmethod
    def __import_type_support__(cls) -> None: ...


class MsgMetaClass(CommonMsgSrvMetaClass, Protocol):
    """The class of the class of a message."""

    _CREATE_ROS_MESSAGE: PyCapsule | None
    _CONVERT_FROM_PY: PyCapsule | None
    _CONVERT_TO_PY: PyCapsule | None
    _DESTROY_ROS_MESSAGE: PyCapsule | None


class Msg(Protocol):
    """A message."""

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the type of each field."""
        ...


MsgT = TypeVar("MsgT", bound=Msg)
SrvRequestT = TypeVar("SrvRequestT", bound=Msg)
SrvResponseT = TypeVar("SrvResponseT", bound=Msg)
GoalT = TypeVar("GoalT", bound=Msg)
ResultT = TypeVar("ResultT", bound=Msg)
FeedbackT = TypeVar("FeedbackT", bound=Msg)


class EventMessage(Protocol[SrvRequestT, SrvResponseT]):
    """An event about the traffic of a service."""

    info: ServiceEventInfo
    request: Sequence[SrvRequestT]
    response: Sequence[SrvResponseT]


class Srv(Protocol[SrvRequestT, SrvResponseT]):
    """A service."""

    Request: type[SrvRequestT]
    Response: type[SrvResponseT]
    Event: type[EventMessage[SrvRequestT, SrvResponseT]]


class SendGoalServiceRequest(Msg, Protocol[GoalT]):
    """A request to accept a goal."""

    goal_id: UUID
    goal: GoalT


class SendGoalServiceResponse(Msg, Protocol):
    """The answer whether a goal is accepted."""

    accepted: bool
    stamp: Time


class GetResultServiceRequest(Msg, Protocol):
    """A request for the result of a goal."""

    goal_id: UUID


class GetResultServiceResponse(Msg, Protocol[ResultT]):
    """The result of a goal."""

    status: int
    result: ResultT


class FeedbackMessage(Msg, Protocol[FeedbackT]):
    """Feedback with the goal that it is about."""

    goal_id: UUID
    feedback: FeedbackT


class SendGoalService(Protocol[GoalT]):
    """The service that accepts goals."""

    Request: type[SendGoalServiceRequest[GoalT]]
    Response: type[SendGoalServiceResponse]


class GetResultService(Protocol[ResultT]):
    """The service that returns results."""

    Request: type[GetResultServiceRequest]
    Response: type[GetResultServiceResponse[ResultT]]


class _Impl(Protocol[GoalT, ResultT, FeedbackT]):
    """The hidden parts of an action."""

    SendGoalService: type[SendGoalService[GoalT]]
    GetResultService: type[GetResultService[ResultT]]
    FeedbackMessage: type[FeedbackMessage[FeedbackT]]
    CancelGoalService: type[CancelGoal]
    GoalStatusMessage: type[GoalStatusArray]


class Action(Protocol[GoalT, ResultT, FeedbackT]):
    """An action."""

    Goal: type[GoalT]
    Result: type[ResultT]
    Feedback: type[FeedbackT]
    Impl: type[_Impl[GoalT, ResultT, FeedbackT]]


SrvT = TypeVar("SrvT", bound=Srv[Any, Any])
ActionT = TypeVar("ActionT", bound=Action[Any, Any, Any])
