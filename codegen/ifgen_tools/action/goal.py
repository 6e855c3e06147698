"""`ifgen action send_goal`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from ifgen.signals import Interrupt, defer_interrupt

from ifgen_tools.action.output import Json, Output, Text
from ifgen_tools.calling import (
    answer,
    class_on_the_wire,
    full_type_name,
    known_class,
    values_or_stdin,
    wait_for_server,
)
from ifgen_tools.errors import ToolError
from ifgen_tools.graph.reading import actions
from ifgen_tools.session import open_session
from ifgen_tools.texts.set_fields import read_yaml, set_fields

if TYPE_CHECKING:
    from ifgen_tools.session import Session, TransportChoice

# Late imports: rclpy is found once the transport has been chosen.

_STATES: Final = {1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}
"""The names of action_msgs/msg/GoalStatus."""

_ENDED: Final = (2, 3)
"""ERROR_UNKNOWN_GOAL_ID and ERROR_GOAL_TERMINATED of action_msgs/srv/CancelGoal."""


def send_goal(
    *,
    name: str,
    type_name: str,
    values: str | None = None,
    from_stdin: bool = False,
    feedback: bool = False,
    transport: TransportChoice = "auto",
    as_json: bool = False,
) -> int:
    """Send a goal, and print what becomes of it. Returns 1 if the server rejects it.

    Ctrl-C cancels it, and waits until it has ended.
    """
    type_name = full_type_name(type_name, "action")
    given = read_yaml(values_or_stdin(values, from_stdin), "the values of the goal")
    with open_session(transport) as session:
        name = session.node.resolve_topic_name(name)
        known = known_class(type_name, "action")
        if isinstance(known, type):
            set_fields(known.Goal(), given)  # a mistake in it is said before anybody is waited for
        output = Json() if as_json else Text()
        wait_for_server(session, "action", name, type_name, lambda: actions(session.node))
        cls = class_on_the_wire(session, "action", name, known)
        goal = cls.Goal()
        now = session.node.get_clock().now().to_msg()
        for stamp in set_fields(goal, given):
            stamp(now)
        with defer_interrupt() as interrupt:
            sending = _Sending(session, name, cls, output, interrupt)
            try:
                is_accepted = sending.run(goal, feedback)
            finally:
                sending.end()
        interrupt.raise_again()
    return 0 if is_accepted else 1


class _Sending:
    """A goal on its way."""

    def __init__(
        self, session: Session, name: str, cls: type[Any], output: Output, interrupt: Interrupt
    ) -> None:
        from rclpy.action import ActionClient

        self._session = session
        self._what = f"action {name!r}"
        self._output = output
        self._interrupt = interrupt
        self._client = ActionClient(session.node, cls, name)

    def run(self, goal: Any, feedback: bool) -> bool:
        """Send the goal, and stay until it has ended. Returns False if the server rejects it."""
        ready, output = self._client.server_is_ready, self._output
        self._session.wait_for(lambda: ready() or bool(self._interrupt.number))
        if self._interrupt.number:
            return False
        output.sending(goal)
        listener = (lambda message: output.feedback(message.feedback)) if feedback else None
        sent = self._client.send_goal_async(goal, feedback_callback=listener)
        handle = answer(self._session, sent, ready, self._what)
        if not handle.accepted:
            output.rejected()
            return False
        output.accepted(bytes(handle.goal_id.uuid).hex())
        result = handle.get_result_async()
        ended = answer(self._session, result, ready, self._what, lambda: bool(self._interrupt.number))
        if ended is None:
            self._cancel(handle)
            ended = answer(self._session, result, ready, self._what)
        output.result(ended.result, _STATES.get(ended.status, "UNKNOWN"))
        return True

    def _cancel(self, handle: Any) -> None:
        """Ask the server to cancel the goal. Raises ToolError if it refuses."""
        self._output.cancelling()
        asked = handle.cancel_goal_async()
        response = answer(self._session, asked, self._client.server_is_ready, self._what)
        if not response.goals_canceling and response.return_code not in _ENDED:
            raise ToolError(f"the server of the {self._what} refuses to cancel the goal, which goes on")

    def end(self) -> None:
        """Let go of the client."""
        self._client.destroy()
