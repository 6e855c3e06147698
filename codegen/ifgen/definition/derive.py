"""The messages and services that rosidl derives from a service's two parts and an action's three."""

from __future__ import annotations

from typing import Final

from ifgen.definition.interfaces import Action, Field, Folder, Message, Service
from ifgen.definition.types import BasicType, BoundedSequence, NamespacedType

_EVENT_INFO: Final = NamespacedType("service_msgs", "msg", "ServiceEventInfo")
_UUID: Final = NamespacedType("unique_identifier_msgs", "msg", "UUID")
_TIME: Final = NamespacedType("builtin_interfaces", "msg", "Time")
_GOAL_ID: Final = Field("goal_id", _UUID, documentation="Which goal this is about.")

ACTION_SUPPORT: Final = (
    ("action_msgs", "srv", "CancelGoal"),
    ("action_msgs", "msg", "GoalStatusArray"),
)
"""Interfaces that every action uses though none of its fields names them."""


def service(package: str, folder: Folder, name: str, request: Message, response: Message) -> Service:
    """The service of these two parts, with the event message that introspection publishes."""
    event = Message(
        package,
        folder,
        f"{name}_Event",
        (
            Field("info", _EVENT_INFO, documentation="What happened, when, and for which client."),
            Field(
                "request",
                BoundedSequence(_type_of(request), 1),
                documentation="The request, if it is included.",
            ),
            Field(
                "response", BoundedSequence(_type_of(response), 1), documentation="The response, if included."
            ),
        ),
        documentation=f"What happened in a call of {name}.",
        span=request.span,
        source=request.source,
    )
    return Service(
        package,
        folder,
        name,
        request,
        response,
        event,
        documentation=request.documentation,
        span=request.span,
        source=request.source,
    )


def action(package: str, name: str, goal: Message, result: Message, feedback: Message) -> Action:
    """The action of these three parts, with the two services and the message that carry them."""

    def derived(suffix: str, documentation: str, *fields: Field) -> Message:
        return Message(
            package,
            "action",
            f"{name}_{suffix}",
            fields,
            documentation=documentation,
            span=goal.span,
            source=goal.source,
        )

    def part(field_name: str, message: Message, documentation: str) -> Field:
        return Field(field_name, _type_of(message), documentation=documentation)

    send_goal = service(
        package,
        "action",
        f"{name}_SendGoal",
        derived(
            "SendGoal_Request", "Asks for a new goal.", _GOAL_ID, part("goal", goal, "What is asked for.")
        ),
        derived(
            "SendGoal_Response",
            "Says whether the goal was accepted.",
            Field("accepted", BasicType("boolean"), documentation="Whether the server takes on the goal."),
            Field("stamp", _TIME, documentation="When the goal was accepted."),
        ),
    )
    get_result = service(
        package,
        "action",
        f"{name}_GetResult",
        derived("GetResult_Request", "Asks for the result of a goal.", _GOAL_ID),
        derived(
            "GetResult_Response",
            "Says how a goal ended.",
            Field("status", BasicType("int8"), documentation="One of the states of action_msgs/GoalStatus."),
            part("result", result, "What came out."),
        ),
    )
    feedback_message = derived(
        "FeedbackMessage",
        "Says how far a goal has come.",
        _GOAL_ID,
        part("feedback", feedback, "How far it has come."),
    )
    return Action(
        package,
        name,
        goal,
        result,
        feedback,
        send_goal,
        get_result,
        feedback_message,
        documentation=goal.documentation,
        span=goal.span,
        source=goal.source,
    )


def _type_of(message: Message) -> NamespacedType:
    return NamespacedType(message.package, message.folder, message.name)
