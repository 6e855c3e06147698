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
    return Action(
        package,
        name,
        goal,
        result,
        feedback,
        _send_goal(name, goal),
        _get_result(name, goal, result),
        _feedback_message(name, goal, feedback),
        documentation=goal.documentation,
        span=goal.span,
        source=goal.source,
    )


def _send_goal(name: str, goal: Message) -> Service:
    carried = Field("goal", _type_of(goal), documentation="What is asked for.")
    accepted = Field("accepted", BasicType("boolean"), documentation="Whether the server takes on the goal.")
    stamp = Field("stamp", _TIME, documentation="When the goal was accepted.")
    name = f"{name}_SendGoal"
    request = _derived(goal, f"{name}_Request", "Asks for a new goal.", _GOAL_ID, carried)
    response = _derived(goal, f"{name}_Response", "Says whether the goal was accepted.", accepted, stamp)
    return service(goal.package, goal.folder, name, request, response)


def _get_result(name: str, goal: Message, result: Message) -> Service:
    status = Field("status", BasicType("int8"), documentation="One of the states of action_msgs/GoalStatus.")
    carried = Field("result", _type_of(result), documentation="What came out.")
    name = f"{name}_GetResult"
    request = _derived(goal, f"{name}_Request", "Asks for the result of a goal.", _GOAL_ID)
    response = _derived(goal, f"{name}_Response", "Says how a goal ended.", status, carried)
    return service(goal.package, goal.folder, name, request, response)


def _feedback_message(name: str, goal: Message, feedback: Message) -> Message:
    carried = Field("feedback", _type_of(feedback), documentation="How far it has come.")
    text = "Says how far a goal has come."
    return _derived(goal, f"{name}_FeedbackMessage", text, _GOAL_ID, carried)


def _derived(goal: Message, name: str, documentation: str, *fields: Field) -> Message:
    """A message that no definition spells out, of the action that this is the goal of."""
    return Message(
        goal.package,
        goal.folder,
        name,
        fields,
        documentation=documentation,
        span=goal.span,
        source=goal.source,
    )


def _type_of(message: Message) -> NamespacedType:
    return NamespacedType(message.package, message.folder, message.name)
