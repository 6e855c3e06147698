"""The lines that `ifgen action send_goal` prints while a goal is on its way."""

from __future__ import annotations

from typing import Any, Protocol

from ifgen_tools.texts.formats import as_json, as_yaml


class Output(Protocol):
    """The events of a goal, in this order."""

    def sending(self, goal: Any) -> None:
        """It is sent to a server."""

    def rejected(self) -> None:
        """The server has refused it: nothing follows."""

    def accepted(self, goal_id: str) -> None:
        """The server has accepted it under an id (hexadecimal)."""

    def feedback(self, feedback: Any) -> None:
        """The server has said how far it is."""

    def cancelling(self) -> None:
        """The user wants it to be cancelled."""

    def result(self, result: Any, state: str) -> None:
        """It has ended."""


class Text:
    """Prints as ROS does."""

    def __init__(self) -> None:
        print("Waiting for an action server to become available...", flush=True)

    def sending(self, goal: Any) -> None:
        """Print the goal."""
        print(f"Sending goal:\n     {as_yaml(goal)}", flush=True)

    def rejected(self) -> None:
        """Print that it was rejected."""
        print("Goal was rejected.", flush=True)

    def accepted(self, goal_id: str) -> None:
        """Print its id."""
        print(f"Goal accepted with ID: {goal_id}\n", flush=True)

    def feedback(self, feedback: Any) -> None:
        """Print the feedback."""
        print(f"Feedback:\n    {as_yaml(feedback)}", flush=True)

    def cancelling(self) -> None:
        """Print that it is being cancelled."""
        print("Canceling goal...", flush=True)

    def result(self, result: Any, state: str) -> None:
        """Print the result and how it ended."""
        if state == "CANCELED":
            print("Goal canceled.")
        print(f"Result:\n    {as_yaml(result)}\nGoal finished with status: {state}", flush=True)


class Json:
    """Prints a line of JSON for each event but the cancelling."""

    def sending(self, goal: Any) -> None:
        """Print `{"goal": ...}`."""
        print(f'{{"goal": {as_json(goal)}}}', flush=True)

    def rejected(self) -> None:
        """Print `{"accepted": false}`."""
        print('{"accepted": false}', flush=True)

    def accepted(self, goal_id: str) -> None:
        """Print `{"accepted": true, "goal_id": ...}`."""
        print(f'{{"accepted": true, "goal_id": "{goal_id}"}}', flush=True)

    def feedback(self, feedback: Any) -> None:
        """Print `{"feedback": ...}`."""
        print(f'{{"feedback": {as_json(feedback)}}}', flush=True)

    def cancelling(self) -> None:
        """Print nothing: the state at the end says it."""

    def result(self, result: Any, state: str) -> None:
        """Print `{"status": "SUCCEEDED", "result": ...}`."""
        print(f'{{"status": "{state}", "result": {as_json(result)}}}', flush=True)
