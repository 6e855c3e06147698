"""`ifgen action send_goal`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen.signals import Interrupt, defer_interrupt

from ifgen_tools.calling import (
    answer,
    class_on_the_wire,
    full_type_name,
    known_class,
    values_or_stdin,
    wait_for_server,
)
from ifgen_tools.ros_graph import actions
from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_json, as_yaml
from ifgen_tools.texts.set_fields import read_yaml, set_fields
from ifgen_tools.verbs import CallOptions

if TYPE_CHECKING:
    from ifgen_tools.session import Session

# Late imports: rclpy is found once the transport has been chosen.

_STATES: Final = {1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}
"""The names of action_msgs/msg/GoalStatus."""

_ENDED: Final = (2, 3)
"""ERROR_UNKNOWN_GOAL_ID and ERROR_GOAL_TERMINATED of action_msgs/srv/CancelGoal."""


def send_goal(chosen: CallOptions) -> int:
    """Send a goal, and print what becomes of it. Returns 1 if the server rejects it.

    Ctrl-C cancels it, and waits until it has ended.
    """
    type_name = full_type_name(chosen.type_name, "action")
    values = read_yaml(values_or_stdin(chosen.values, chosen.from_stdin), "the values of the goal")
    with open_session(chosen.transport) as session:
        name = session.node.resolve_topic_name(chosen.name)
        known = known_class(type_name, "action")
        if isinstance(known, type):
            set_fields(known.Goal(), values)  # a mistake in it is said before anybody is waited for
        output = _Output(in_json=chosen.as_json)
        wait_for_server(session, "action", name, type_name, lambda: actions(session.node))
        cls = class_on_the_wire(session, "action", name, known)
        goal = cls.Goal()
        now = session.node.get_clock().now().to_msg()
        for stamp in set_fields(goal, values):
            stamp(now)
        with defer_interrupt() as interrupt:
            sending = _Sending(session, name, cls, output, interrupt)
            try:
                is_accepted = sending.run(goal, chosen.feedback)
            finally:
                sending.end()
        interrupt.raise_again()
    return 0 if is_accepted else 1


class _Output:
    """Prints the events of a goal, in this order: as ROS does, or each as a line of JSON."""

    def __init__(self, *, in_json: bool) -> None:
        self._in_json = in_json
        if not in_json:
            print("Waiting for an action server to become available...", flush=True)

    def sending(self, goal: Any) -> None:
        """Print the goal that is sent."""
        text = f'{{"goal": {as_json(goal)}}}' if self._in_json else f"Sending goal:\n     {as_yaml(goal)}"
        print(text, flush=True)

    def rejected(self) -> None:
        """Print that the server has refused it; nothing follows."""
        print('{"accepted": false}' if self._in_json else "Goal was rejected.", flush=True)

    def accepted(self, goal_id: str) -> None:
        """Print the id (hexadecimal) under which the server has accepted it."""
        accepted = f'{{"accepted": true, "goal_id": "{goal_id}"}}'
        print(accepted if self._in_json else f"Goal accepted with ID: {goal_id}\n", flush=True)

    def feedback(self, feedback: Any) -> None:
        """Print feedback."""
        text = as_json(feedback) if self._in_json else as_yaml(feedback)
        print(f'{{"feedback": {text}}}' if self._in_json else f"Feedback:\n    {text}", flush=True)

    def cancelling(self) -> None:
        """Print that the user wants it to be cancelled; in JSON, the status at the end says so."""
        if not self._in_json:
            print("Canceling goal...", flush=True)

    def result(self, result: Any, state: str) -> None:
        """Print the result, and how it ended."""
        if self._in_json:
            print(f'{{"status": "{state}", "result": {as_json(result)}}}', flush=True)
            return
        if state == "CANCELED":
            print("Goal canceled.")
        print(f"Result:\n    {as_yaml(result)}\nGoal finished with status: {state}", flush=True)


class _Sending:
    """A goal on its way."""

    def __init__(
        self, session: Session, name: str, cls: type[Any], output: _Output, interrupt: Interrupt
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
